#include "sim/sim_drive.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/quantity.hpp"
#include "sim/known_objects.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;
using canopen::NmtCommand;
using canopen::NmtState;

namespace {

/// From a reset to the boot-up message.
constexpr Duration kBootTime = std::chrono::milliseconds(50);
constexpr std::size_t kHistorySize = 8;
/// EMCY of a life guarding or heartbeat error (CiA 301, table 26).
constexpr std::uint16_t kLifeGuardError = 0x8130;

canopen::SdoServer::Options server_options(const drive::Rules& rules) {
  canopen::SdoServer::Options options;
  options.segmented = rules.sdo.segmented;
  options.block = rules.sdo.segmented && rules.sdo.block;
  return options;
}

}  // namespace

SimDrive::SimDrive(const drive::Profile& profile, std::uint8_t node, Memory& memory, std::string key)
    : profile_(&profile),
      memory_(&memory),
      key_(std::move(key)),
      node_(node),
      values_(profile),
      power_(profile.rules),
      server_(node, *this, server_options(profile.rules)),
      error_control_(node) {
  auto& cells = memory_->cells(key_);
  const auto* node_id = parameter(profile.rules.nmt.node_id);
  if (node_id == nullptr || !node_id->object || cells.find(*node_id->object) != cells.end()) return;
  if (!node_id->default_value || od::to_double(*node_id->default_value) != node)
    cells[*node_id->object] = store_le(node, od::size_of(node_id->type).value_or(1));
}

void SimDrive::on_frame(const can::Frame& frame, TimePoint now) {
  now_ = now;
  if (misbehaviour_.silent || boot_at_ != kNever) return;
  if (const auto message = canopen::parse_nmt(frame)) {
    if (message->node == 0 || message->node == node_) on_nmt(message->command, now);
    return;
  }
  error_control_.on_frame(frame, now);
  while (const auto answer = error_control_.take_frame()) tx_.push_back(*answer);
  if (nmt_ == NmtState::stopped) return;  // CiA 301, table 39: no SDO in this state.
  server_.on_frame(frame, now);
  collect_answers(now);
}

void SimDrive::collect_answers(TimePoint now) {
  while (const auto answer = server_.take_frame()) {
    if (misbehaviour_.drop_answers > 0) {
      --misbehaviour_.drop_answers;
      continue;
    }
    const int copies = misbehaviour_.duplicate_answers > 0 ? 2 : 1;
    if (copies == 2) --misbehaviour_.duplicate_answers;
    for (int i = 0; i < copies; ++i) {
      if (misbehaviour_.answer_delay > Duration::zero())
        late_.push_back({*answer, now + misbehaviour_.answer_delay});
      else
        tx_.push_back(*answer);
    }
  }
}

void SimDrive::on_time(TimePoint now) {
  now_ = now;
  if (now >= planned_silence_) {
    misbehaviour_.silent = true;
    planned_silence_ = kNever;
  }
  if (misbehaviour_.silent) return;
  if (now >= boot_at_) power_on(now);
  power_.on_time(now);
  server_.on_time(now);
  collect_answers(now);
  while (!late_.empty() && now >= late_.front().time) {
    tx_.push_back(late_.front().frame);
    late_.pop_front();
  }
  error_control_.on_time(now);
  while (const auto heartbeat = error_control_.take_frame()) tx_.push_back(*heartbeat);
  if (error_control_.take_life_lost()) on_life_lost(now);
  if (planned_fault_ && now >= planned_fault_->time)
    raise_fault(std::exchange(planned_fault_, std::nullopt)->code, {}, now);
}

TimePoint SimDrive::deadline() const {
  if (misbehaviour_.silent) return kNever;
  auto next = std::min(
      {boot_at_, power_.deadline(), server_.deadline(), error_control_.deadline(), planned_silence_});
  if (!late_.empty()) next = std::min(next, late_.front().time);
  if (planned_fault_) next = std::min(next, planned_fault_->time);
  return next;
}

std::optional<can::Frame> SimDrive::take_frame() {
  if (tx_.empty()) return std::nullopt;
  const auto frame = tx_.front();
  tx_.pop_front();
  return frame;
}

void SimDrive::power_on(TimePoint now) {
  boot_at_ = kNever;
  if (full_restart_) {
    restore_if_asked();
    values_.load_defaults(node_);
    for (const auto& cell : memory_->cells(key_)) values_.set(cell.first, cell.second);
    const auto* node_id = parameter(profile_->rules.nmt.node_id);
    if (node_id != nullptr && node_id->object) {
      const auto set_to = values_.number(*node_id->object);
      if (set_to >= canopen::kFirstNode && set_to <= canopen::kLastNode && set_to != node_) {
        node_ = static_cast<std::uint8_t>(set_to);
        values_.load_defaults(node_);
        for (const auto& cell : memory_->cells(key_)) values_.set(cell.first, cell.second);
      }
    }
    at_start_.clear();
    for (const auto& p : profile_->parameters)
      if (p.object && p.effect == od::Effect::restart) at_start_[*p.object] = values_.number(*p.object);
    power_.reset();
    history_.clear();
  }
  load_mirrors();
  server_ = canopen::SdoServer(node_, *this, server_options(profile_->rules));
  const auto* autostart = parameter(profile_->rules.nmt.autostart);
  const bool start = autostart != nullptr && autostart->object && effective(*autostart->object) == 1;
  nmt_ = start ? NmtState::operational : NmtState::pre_operational;
  error_control_ = canopen::ErrorControlSlave(node_);
  error_control_.boot(nmt_, now);
  tx_.push_back(*error_control_.take_frame());
  set_up_error_control(now);
}

void SimDrive::on_nmt(NmtCommand command, TimePoint now) {
  switch (command) {
    case NmtCommand::start: return set_nmt(NmtState::operational);
    case NmtCommand::stop: return set_nmt(NmtState::stopped);
    case NmtCommand::enter_pre_operational: return set_nmt(NmtState::pre_operational);
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      full_restart_ = command == NmtCommand::reset_node;
      boot_at_ = now + kBootTime;
      error_control_.stop();
      server_.reset();
      late_.clear();
      nmt_ = NmtState::initialising;
  }
}

void SimDrive::set_nmt(NmtState state) {
  nmt_ = state;
  error_control_.set_state(state);
}

void SimDrive::set_up_error_control(TimePoint now) {
  error_control_.set_heartbeat(std::chrono::milliseconds(values_.number(kHeartbeatTime)), now);
  error_control_.set_life_time(std::chrono::milliseconds(values_.number(kGuardTime)),
                               static_cast<std::uint32_t>(values_.number(kLifeFactor)));
}

/// The master has stopped asking.
void SimDrive::on_life_lost(TimePoint now) {
  const auto* alarm = parameter(profile_->rules.nmt.guarding_alarm);
  const bool masked = alarm != nullptr && alarm->object && effective(*alarm->object) == 0;
  if (!masked) raise_fault(kLifeGuardError, {}, now);
}

std::uint32_t SimDrive::read(ObjectAddress object, Bytes& out) {
  if (const auto code = values_.check_read(object); code != 0) return code;
  if (object == kStatusword) {
    out = store_le(power_.statusword(static_cast<std::int8_t>(values_.number(kModeDisplay))), 2);
    return 0;
  }
  if (object.index == kErrorHistory.index) {
    if (object.sub == 0) out = store_le(history_.size(), 1);
    if (object.sub > 0 && object.sub > history_.size()) return abort::kNoData;
    if (object.sub > 0) out = store_le(history_[object.sub - 1U], 4);
    return 0;
  }
  out = values_.get(object);
  return 0;
}

std::uint32_t SimDrive::check_state(ObjectAddress object, ByteSpan data) const {
  const auto target = drive::target_at(profile_, object);
  const auto effect = drive::meaning(target, node_).effect;
  if (effect == od::Effect::standstill && drive::is_energised(power_.state())) return abort::kDeviceState;
  if (object == kModes && target.entry != nullptr && !target.entry->labels.empty()) {
    const auto value = od::decode(target.entry->type, data);
    if (!value || drive::label_of(drive::meaning(target, node_), *value) == nullptr) return abort::kRange;
  }
  return 0;
}

std::uint32_t SimDrive::write(ObjectAddress object, ByteSpan data) {
  if (object == kErrorHistory && data.size() == 1 && data[0] != 0) return abort::kRange;
  if (const auto code = values_.check_write(object, data, node_); code != 0) return code;
  if (const auto code = check_state(object, data); code != 0) return code;
  bool handled = false;
  if (const auto code = write_command(object, data, handled); code != 0 || handled) return code;
  values_.set(object, data);
  after_write(object, data);
  return 0;
}

std::uint32_t SimDrive::write_command(ObjectAddress object, ByteSpan data, bool& handled) {
  handled = true;
  if (object == kErrorHistory) {
    history_.clear();
    return 0;
  }
  if (object == kStore) return load_le(data) == kSaveSignature ? save_objects() : abort::kCannotStore;
  if (object == kRestore) {
    if (load_le(data) != kLoadSignature) return abort::kCannotStore;
    memory_->cells(key_).clear();
    return memory_->save() ? 0 : abort::kCannotStore;
  }
  handled = false;
  return 0;
}

void SimDrive::after_write(ObjectAddress object, ByteSpan data) {
  const auto* parameter = profile_->parameter(object);
  if (parameter != nullptr && parameter->access == od::Access::rw && !parameter->is_volatile) {
    memory_->cells(key_)[object] = Bytes(data.begin(), data.end());
    (void)memory_->save();
  }
  if (object == kHeartbeatTime || object == kGuardTime || object == kLifeFactor) set_up_error_control(now_);
  if (object == kModes) values_.set(kModeDisplay, data);
  if (object == kControlword) {
    const auto& gate = profile_->rules.fault.reset_enabled_by;
    const bool may_reset = !gate || effective(gate->object) == gate->value;
    power_.on_controlword(static_cast<std::uint16_t>(load_le(data)),
                          static_cast<std::int64_t>(values_.number(kQuickStopOption)), may_reset, now_);
    if (power_.was_reset()) {
      values_.set_number(kErrorCode, 0);
      values_.set_number(kErrorRegister, 0);
      send_emergency(0, {});
    }
  }
}

void SimDrive::raise_fault(std::uint16_t code, std::array<std::uint8_t, 5> vendor, TimePoint now) {
  power_.raise_fault(now);
  values_.set_number(kErrorCode, code);
  values_.set_number(kErrorRegister, 0x81);  // Generic and manufacturer specific.
  history_.push_front(static_cast<std::uint32_t>(vendor[0] | vendor[1] << 8U) << 16U | code);
  if (history_.size() > kHistorySize) history_.pop_back();
  send_emergency(code, vendor);
}

void SimDrive::send_emergency(std::uint16_t code, std::array<std::uint8_t, 5> vendor) {
  if (nmt_ == NmtState::stopped || nmt_ == NmtState::initialising) return;
  canopen::Emergency emergency;
  emergency.node = node_;
  emergency.code = code;
  emergency.error_register = static_cast<std::uint8_t>(values_.number(kErrorRegister));
  emergency.vendor = vendor;
  tx_.push_back(canopen::emergency_frame(emergency));
}

}  // namespace servoctl::sim
