// How a drive model fails, and what it says of it.
#include <algorithm>

#include "base/pdo_index.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "sim/drive_model.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;

namespace {

constexpr std::uint16_t kQuickStopWord = 0x0002;

}  // namespace

void DriveModel::raise_fault(std::uint16_t code, std::array<std::uint8_t, 5> vendor, TimePoint now) {
  now_ = now;
  const auto found = drive::faults_of(profile_->faults, profile_->rules.emergency, code, vendor);
  if (!found.empty() && found.front()->kind == drive::Fault::Kind::status) return tell(code, vendor);
  fault_ = found.size() == 1 ? found.front() : nullptr;
  axis_.advance(motor_drive(), now);
  const bool turns = drive::is_energised(power_.state());
  const auto before = power_.state();
  power_.raise_fault(now);
  if (power_.state() != before) begin_stop(turns ? profile_->rules.fault.ramp : std::string());
  values_.set_number(objects::kErrorCode, code);
  if (const auto alarm = drive::resolve(profile_, profile_->rules.fault.alarm); alarm)
    values_.set_number(alarm->address, code);
  begin_error(ErrorLog::Source::fault, code, vendor);
}

void DriveModel::begin_error(ErrorLog::Source source, std::uint16_t code,
                             std::array<std::uint8_t, 5> vendor) {
  errors_.begin(source, code, static_cast<std::uint16_t>(vendor[0] | vendor[1] << 8U));
  values_.set_number(objects::kErrorRegister, errors_.error_register());
  tell(code, vendor);
}

void DriveModel::end_error(ErrorLog::Source source) {
  if (!errors_.end(source)) return;
  values_.set_number(objects::kErrorRegister, errors_.error_register());
  tell(0, {});
}

void DriveModel::on_master_lost(std::uint16_t code, TimePoint now) {
  now_ = now;
  enum : std::uint64_t { kNoAction, kFault, kDisable, kQuickStop };
  const bool has_option = values_.has(objects::kAbortConnectionOption);
  const auto option = has_option ? values_.number(objects::kAbortConnectionOption) : kFault;
  if (option == kFault) return raise_fault(code, {}, now);
  begin_error(ErrorLog::Source::master, code);
  if (option == kDisable) power_.disable();
  move_axis();
  if (option == kQuickStop) give_controlword(kQuickStopWord);
}

/// Some families take a wrong access for a fault of the drive.
void DriveModel::raise_access_alarm(ObjectAddress object, std::uint32_t code) {
  const auto& rules = profile_->rules.fault;
  std::string_view panel;
  if (code == abort::kLength || code == abort::kTooLong || code == abort::kTooShort)
    panel = rules.length_alarm;
  if (code == abort::kTooHigh || code == abort::kTooLow || code == abort::kRange) panel = rules.range_alarm;
  if (code == abort::kReadOnly) panel = rules.access_alarm;
  if (code == abort::kNoObject) panel = rules.object_alarm;
  if (code == abort::kNoSubIndex) panel = rules.sub_index_alarm;
  if (code == abort::kDeviceState && is_pdo_mapping(object.index)) panel = rules.mapping_alarm;
  (void)raise_alarm(panel);
}

/// Raises the fault the panel shows like this; false when the family's table has none.
bool DriveModel::raise_alarm(std::string_view panel) {
  const auto& faults = profile_->faults;
  const auto found =
      std::find_if(faults.begin(), faults.end(), [&](const auto& f) { return f.panel == panel; });
  if (panel.empty() || found == faults.end() || !found->code) return false;
  raise_fault(*found->code, drive::panel_bytes(profile_->rules.emergency, panel), now_);
  return true;
}

bool DriveModel::may_reset() const {
  const auto& gate = profile_->rules.fault.reset_enabled_by;
  if (gate && effective(gate->object) != gate->value) return false;
  return fault_ == nullptr || fault_->resettable.value_or(true);
}

void DriveModel::clear_fault() {
  fault_ = nullptr;
  errors_.end(ErrorLog::Source::fault);
  axis_.clear_error();
  values_.set_number(objects::kErrorCode, 0);
  values_.set_number(objects::kErrorRegister, errors_.error_register());
  if (const auto alarm = drive::resolve(profile_, profile_->rules.fault.alarm); alarm)
    values_.set_number(alarm->address, 0);
  tell(0, {});
}

void DriveModel::tell(std::uint16_t code, std::array<std::uint8_t, 5> vendor) {
  const auto error_register = static_cast<std::uint8_t>(values_.number(objects::kErrorRegister));
  emergencies_.push_back({code, error_register, vendor});
}

std::optional<Emergency> DriveModel::take_emergency() {
  if (emergencies_.empty()) return std::nullopt;
  const auto out = emergencies_.front();
  emergencies_.pop_front();
  return out;
}

}  // namespace servoctl::sim
