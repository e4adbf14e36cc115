// How a simulated drive fails, and what it says of it.
#include <algorithm>

#include "canopen/sdo_abort.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "sim/pdo_guard.hpp"
#include "sim/sim_drive.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;
using canopen::NmtState;

namespace {

/// EMCY of a life guarding or heartbeat error (CiA 301, table 26).
constexpr std::uint16_t kLifeGuardError = 0x8130;
constexpr std::uint16_t kQuickStopWord = 0x0002;
/// Of 1014h: bit 31, the drive sends no EMCY; its CAN-ID has 11 bits.
constexpr std::uint32_t kNoEmergency = 0x8000'0000;
constexpr std::uint32_t kCanId = 0x7FF;

}  // namespace

void SimDrive::raise_fault(std::uint16_t code, std::array<std::uint8_t, 5> vendor, TimePoint now) {
  now_ = now;
  const auto found = drive::faults_of(profile_->faults, profile_->rules.emergency, code, vendor);
  if (!found.empty() && found.front()->kind == drive::Fault::Kind::status)
    return send_emergency(code, vendor);
  fault_ = found.size() == 1 ? found.front() : nullptr;
  power_.raise_fault(now);
  values_.set_number(objects::kErrorCode, code);
  if (const auto alarm = drive::resolve(profile_, profile_->rules.fault.alarm); alarm)
    values_.set_number(alarm->address, code);
  begin_error(ErrorLog::Source::fault, code, vendor);
}

/// An error that is no fault of the drive, or is one: told once, when it begins.
void SimDrive::begin_error(ErrorLog::Source source, std::uint16_t code, std::array<std::uint8_t, 5> vendor) {
  errors_.begin(source, code, static_cast<std::uint16_t>(vendor[0] | vendor[1] << 8U));
  values_.set_number(objects::kErrorRegister, errors_.error_register());
  send_emergency(code, vendor);
}

/// It is over: code 0000h tells so, with what is still wrong in the register (CiA 301, 7.2.7.1).
void SimDrive::end_error(ErrorLog::Source source) {
  if (!errors_.end(source)) return;
  values_.set_number(objects::kErrorRegister, errors_.error_register());
  send_emergency(0, {});
}

/// A heartbeat that 1016h watches, or the question of life guarding, has not come: emergency, what 6007h
/// says, and the NMT state that 1029h names.
void SimDrive::on_master_lost(TimePoint now) {
  react_to_lost_master(now);
  enter_error_state();
}

/// CiA 301, 7.5.2.32: from Operational to Pre-operational, also of a drive without the object.
void SimDrive::enter_error_state() {
  enum : std::uint64_t { kPreOperational, kNoChange, kStopped };
  const auto object = objects::kCommunicationErrorBehaviour;
  const auto behaviour = values_.has(object) ? values_.number(object) : kPreOperational;
  if (behaviour == kPreOperational && nmt_ == NmtState::operational) set_nmt(NmtState::pre_operational);
  if (behaviour == kStopped) set_nmt(NmtState::stopped);
}

/// 6007h; a fault where there is none.
void SimDrive::react_to_lost_master(TimePoint now) {
  enum : std::uint64_t { kNoAction, kFault, kDisable, kQuickStop };
  const bool has_option = values_.has(objects::kAbortConnectionOption);
  const auto option = has_option ? values_.number(objects::kAbortConnectionOption) : kFault;
  if (option == kFault) return raise_fault(kLifeGuardError, {}, now);
  begin_error(ErrorLog::Source::master, kLifeGuardError, {});
  if (option == kDisable) power_.disable();
  if (option == kQuickStop) power_.on_controlword(kQuickStopWord, 0, false, now);
}

/// Some families take a wrong access for a fault of the drive.
void SimDrive::raise_access_alarm(ObjectAddress object, std::uint32_t code) {
  const auto& rules = profile_->rules.fault;
  std::string_view panel;
  if (code == abort::kLength || code == abort::kTooLong || code == abort::kTooShort)
    panel = rules.length_alarm;
  if (code == abort::kTooHigh || code == abort::kTooLow || code == abort::kRange) panel = rules.range_alarm;
  if (code == abort::kReadOnly) panel = rules.access_alarm;
  if (code == abort::kDeviceState && is_pdo_mapping(object.index)) panel = rules.mapping_alarm;
  (void)raise_alarm(panel);
}

/// Raises the fault the panel shows like this; false when the family's table has none.
bool SimDrive::raise_alarm(std::string_view panel) {
  const auto& faults = profile_->faults;
  const auto found =
      std::find_if(faults.begin(), faults.end(), [&](const auto& f) { return f.panel == panel; });
  if (panel.empty() || found == faults.end() || !found->code) return false;
  raise_fault(*found->code, drive::panel_bytes(profile_->rules.emergency, panel), now_);
  return true;
}

bool SimDrive::may_reset() const {
  const auto& gate = profile_->rules.fault.reset_enabled_by;
  if (gate && effective(gate->object) != gate->value) return false;
  return fault_ == nullptr || fault_->resettable.value_or(true);
}

void SimDrive::clear_fault() {
  fault_ = nullptr;
  errors_.end(ErrorLog::Source::fault);
  axis_.clear_error();
  values_.set_number(objects::kErrorCode, 0);
  values_.set_number(objects::kErrorRegister, errors_.error_register());
  if (const auto alarm = drive::resolve(profile_, profile_->rules.fault.alarm); alarm)
    values_.set_number(alarm->address, 0);
  send_emergency(0, {});
}

/// Under the COB-ID in 1014h, unless its bit 31 says that there is none; under that of the pre-defined
/// connection set where there is no such object.
void SimDrive::send_emergency(std::uint16_t code, std::array<std::uint8_t, 5> vendor) {
  if (nmt_ == NmtState::stopped || nmt_ == NmtState::initialising) return;
  const auto cob_id = static_cast<std::uint32_t>(values_.number(objects::kEmergencyCobId));
  if ((cob_id & kNoEmergency) != 0) return;
  canopen::Emergency emergency;
  emergency.node = node_;
  emergency.code = code;
  emergency.error_register = static_cast<std::uint8_t>(values_.number(objects::kErrorRegister));
  emergency.vendor = vendor;
  emergency.size = profile_->rules.emergency.size;
  auto frame = canopen::emergency_frame(emergency);
  if (values_.has(objects::kEmergencyCobId)) frame.id = cob_id & kCanId;
  emergencies_.push(frame);
  collect_emergencies();
}

void SimDrive::collect_emergencies() {
  while (const auto frame = emergencies_.take_frame(emergency_inhibit(), now_)) tx_.push_back(*frame);
}

Duration SimDrive::emergency_inhibit() const {
  return values_.number(objects::kEmergencyInhibit) * std::chrono::microseconds(100);
}

}  // namespace servoctl::sim
