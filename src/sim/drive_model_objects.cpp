// What a drive model answers to reads and writes.
#include <algorithm>

#include "base/pdo_index.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "sim/drive_model.hpp"
#include "sim/mapping_guard.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;

namespace {

/// Bit 9 of the statusword: the controlword is obeyed (CiA 402-2, 8.4.2).
constexpr std::uint16_t kRemote = 1U << 9U;

}  // namespace

std::uint32_t DriveModel::read(ObjectAddress object, Bytes& out) {
  const bool is_missing = misbehaviour_.missing.contains(object.index);
  if (!is_missing && misbehaviour_.unreadable.contains(object.index)) return abort::kWriteOnly;
  if (const auto code = is_missing ? abort::kNoObject : values_.check_read(object); code != 0) {
    if (code == abort::kNoObject || code == abort::kNoSubIndex) raise_access_alarm(object, code);
    return code;
  }
  move_axis();
  if (object == objects::kStatusword && misbehaviour_.statusword) {
    out = store_le(*misbehaviour_.statusword, 2);
    return 0;
  }
  if (object == objects::kModeDisplay && misbehaviour_.mode) {
    out = store_le(static_cast<std::uint64_t>(*misbehaviour_.mode), 1);
    return 0;
  }
  if (object == objects::kStatusword) {
    const auto mode = static_cast<std::int8_t>(values_.number(objects::kModeDisplay));
    const bool remote = obeys_bus() || !profile_->rules.remote_bit;
    const auto word = power_.statusword(mode) & (remote ? 0xFFFFU : ~unsigned{kRemote});
    out = store_le(static_cast<std::uint16_t>(word | axis_.bits(is_enabled())), 2);
    return 0;
  }
  if (object.index == objects::kErrorHistory.index) {
    const auto& history = errors_.history();
    if (object.sub == 0) out = store_le(history.size(), 1);
    if (object.sub > 0 && object.sub > history.size()) return abort::kNoData;
    if (object.sub > 0) out = store_le(history[object.sub - 1U], 4);
    return 0;
  }
  out = values_.get(object);
  return 0;
}

std::uint32_t DriveModel::check_state(ObjectAddress object, ByteSpan data) const {
  const auto target = drive::target_at(profile_, object);
  const auto effect = drive::meaning(target, node_).effect;
  const bool refuses = !profile_->rules.store.defers_standstill;
  if (effect == od::Effect::standstill && refuses && drive::is_energised(power_.state()))
    return abort::kDeviceState;
  // Mode 0 is "no mode": what a drive without a default starts in (CiA 402-2, 6060h).
  const bool no_mode = target.entry != nullptr && load_le(data) == 0 &&
                       (!target.entry->default_value || load_le(values_.get(objects::kModeDisplay)) == 0);
  if (object == objects::kModeOfOperation && !no_mode && target.entry != nullptr &&
      !target.entry->labels.empty()) {
    const auto value = od::decode(target.entry->type, data);
    if (!value || drive::label_of(drive::meaning(target, node_), *value) == nullptr) return abort::kRange;
  }
  if (is_locked(object)) return abort::kLocalControl;
  if (const auto code = port_ == nullptr ? 0 : port_->check_write(object, data); code != 0) return code;
  return MappingGuard(*profile_, values_).check(object, data);
}

/// Parameters behind a password; the password itself never is.
bool DriveModel::is_locked(ObjectAddress object) const {
  const auto& store = profile_->rules.store;
  const auto* password = parameter(store.unlock);
  if (password == nullptr || !password->object || !store.unlock_open) return false;
  const auto guarded = [&](const std::string& id) {
    const auto* p = parameter(id);
    return p != nullptr && p->object == object;
  };
  return std::any_of(store.locked.begin(), store.locked.end(), guarded) &&
         static_cast<std::int64_t>(values_.number(*password->object)) != *store.unlock_open;
}

std::uint32_t DriveModel::check_writable(ObjectAddress object) {
  const bool is_missing = misbehaviour_.missing.contains(object.index);
  const auto code = is_missing ? abort::kNoObject : values_.check_writable(object);
  if (code != 0) raise_access_alarm(object, code);
  return code;
}

std::size_t DriveModel::expedited_size(ObjectAddress object, std::size_t announced) {
  const auto& taken = profile_->rules.sdo.short_writes;
  const auto* entry = profile_->dictionary.find(object);
  if (entry == nullptr || std::find(taken.begin(), taken.end(), object) == taken.end()) return announced;
  return std::max(announced, od::size_of(entry->type).value_or(announced));
}

/// 60C2h:01 where its period has limits: a value outside them is taken as the nearest one.
Bytes DriveModel::taken_period(ByteSpan data) const {
  const auto& limits = profile_->rules.motion.interpolation_ms;
  return store_le(std::clamp<std::uint64_t>(load_le(data), limits.front(), limits.back()), data.size());
}

std::uint32_t DriveModel::write(ObjectAddress object, ByteSpan data) {
  Bytes taken;
  if (object == objects::kInterpolationPeriod && !profile_->rules.motion.interpolation_ms.empty() &&
      !data.empty() && data.size() <= 8) {
    taken = taken_period(data);
    data = taken;
  }
  if (misbehaviour_.missing.contains(object.index)) {
    raise_access_alarm(object, abort::kNoObject);
    return abort::kNoObject;
  }
  if (misbehaviour_.refused.contains(object.index)) return abort::kDeviceState;
  if (misbehaviour_.feigned.contains(object.index)) return 0;
  if (object == objects::kErrorHistory && data.size() == 1 && data[0] != 0) return abort::kRange;
  auto code = values_.check_write(object, data, node_);
  // A count beyond the entries is no value of the wrong range, whatever limit its entry has.
  if (code == abort::kTooHigh && is_pdo_mapping(object.index) && object.sub == 0) code = abort::kPdoLength;
  if (code == 0) code = check_state(object, data);
  if (code != 0) {
    raise_access_alarm(object, code);
    return code;
  }
  bool handled = false;
  code = write_command(object, data, handled);
  if (code != 0 || handled) return code;
  axis_.advance(motor_drive(), now_);  // Up to now it moved by the old values.
  const auto effect = drive::meaning(drive::target_at(profile_, object), node_).effect;
  if (effect == od::Effect::standstill && drive::is_energised(power_.state())) values_.hold(object);
  values_.set(object, data);
  after_write(object, data);
  return 0;
}

std::uint32_t DriveModel::write_command(ObjectAddress object, ByteSpan data, bool& handled) {
  handled = true;
  if (object == objects::kErrorHistory) {
    errors_.clear_history();
    return 0;
  }
  if (object.index == objects::kStoreIndex)
    return load_le(data) == objects::kSaveSignature ? save_objects(object.sub) : abort::kCannotStore;
  if (object.index == objects::kRestoreIndex)
    return load_le(data) == objects::kLoadSignature ? restore_objects(object.sub) : abort::kCannotStore;
  handled = false;
  return 0;
}

/// Whether a write to this object goes to the memory that outlives power-off, at once.
bool DriveModel::is_kept(ObjectAddress object) const {
  const auto* parameter = profile_->parameter(object);
  const auto& rules = profile_->rules.store;
  if (rules.flash_switch.empty())
    return parameter != nullptr && parameter->access == od::Access::rw && !parameter->is_volatile;
  const auto* entry = profile_->dictionary.find(object);
  const bool setting =
      entry != nullptr && entry->access == od::Access::rw && !entry->command && !entry->is_volatile;
  const auto flash = drive::resolve(profile_, rules.flash_switch);
  const bool of_vendor = object.index >= 0x2000 && object.index < 0x6000;
  return setting && of_vendor && flash && flash->address != object && rules.to_flash &&
         static_cast<std::int64_t>(effective(flash->address)) == *rules.to_flash;
}

/// Whether a controlword is taken and not obeyed.
bool DriveModel::feigns(std::uint16_t controlword) {
  const auto command = drive::decode_command(controlword, controlword);
  const bool down = command == drive::ControlCommand::disable_voltage ||
                    command == drive::ControlCommand::quick_stop ||
                    command == drive::ControlCommand::switch_on;
  if (misbehaviour_.ignores_disable && down && is_enabled()) return true;
  if (!misbehaviour_.stays_switched_on || command != drive::ControlCommand::disable_voltage) return false;
  constexpr std::uint16_t kSwitchOn = 0x07;
  power_.on_controlword(kSwitchOn, 0, false, now_);
  return true;
}

/// Whether the parameters that select the source of commands say "the bus", as they took effect.
bool DriveModel::obeys_bus() const {
  const auto& needs = profile_->rules.nmt.needs;
  return std::all_of(needs.begin(), needs.end(), [&](const drive::Setting& need) {
    const auto place = drive::place_of(*profile_, need.name);
    return !place || static_cast<std::int64_t>(effective(*place)) == need.value;
  });
}

void DriveModel::on_controlword(std::uint16_t controlword) {
  if (!obeys_bus() || feigns(controlword)) return;
  give_controlword(controlword);
  if (power_.was_reset()) clear_fault();
  axis_.on_controlword(controlword, motor_drive(), now_);
}

/// Gives the controlword to the power stage; where that begins a quick stop, 605Ah says by which ramp.
void DriveModel::give_controlword(std::uint16_t controlword) {
  const auto option = static_cast<std::int64_t>(values_.number(objects::kQuickStopOption));
  const auto before = power_.state();
  power_.on_controlword(controlword, option, may_reset(), now_);
  if (power_.state() == before || power_.state() != drive::DriveState::quick_stop_active) return;
  const auto& ramps = profile_->rules.quick_stop_ramps;
  const auto ramp = ramps.find(option);
  begin_stop(ramp == ramps.end() ? std::string() : ramp->second);
}

void DriveModel::begin_stop(const std::string& ramp) {
  ramps_down_ = !ramp.empty();
  if (ramps_down_) power_.stop_until(now_ + axis_.begin_stop(ramp));
}

Axis::Drive DriveModel::motor_drive() const {
  if (is_enabled()) return Axis::Drive::obeying;
  return ramps_down_ && drive::is_energised(power_.state()) ? Axis::Drive::stopping : Axis::Drive::released;
}

void DriveModel::after_write(ObjectAddress object, ByteSpan data) {
  if (is_kept(object)) {
    memory_->cells(key_)[object] = Bytes(data.begin(), data.end());
    ++flash_writes_;
    (void)memory_->save();
  }
  if (profile_->rules.pdo.clears_entries && is_pdo_mapping(object.index) && object.sub == 0 &&
      load_le(data) == 0)
    if (const auto* mapping = profile_->dictionary.object(object.index))
      for (const auto& entry : mapping->entries) values_.set_number(entry.address, 0);
  if (port_ != nullptr) port_->on_written(object);
  if (object == objects::kModeOfOperation) values_.set(objects::kModeDisplay, data);
  if (object == objects::kControlword) on_controlword(static_cast<std::uint16_t>(load_le(data)));
  for (const auto& setting : profile_->rules.fault.reset) {
    const auto target = drive::resolve(profile_, setting.name);
    if (!target || target->address != object || static_cast<std::int64_t>(load_le(data)) != setting.value)
      continue;
    if (may_reset() && power_.reset_fault()) clear_fault();
    values_.set_number(object, 0);
  }
}

}  // namespace servoctl::sim
