#include "sim/can_port.hpp"

#include <algorithm>
#include <optional>

#include "canopen/cob_id.hpp"
#include "canopen/cob_id_rules.hpp"
#include "canopen/emergency.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/standard_objects.hpp"
#include "sim/communication_guard.hpp"
#include "sim/pdo_guard.hpp"

namespace servoctl::sim {
using canopen::NmtCommand;
using canopen::NmtState;

namespace {

/// From a reset to the boot-up message.
constexpr Duration kBootTime = std::chrono::milliseconds(50);
/// EMCY of an RPDO that was too short to be taken, and of one of which the first bytes were; of a life
/// guarding or heartbeat error (CiA 301, table 26).
constexpr std::uint16_t kPdoLengthError = 0x8210;
constexpr std::uint16_t kPdoLengthExceeded = 0x8220;
constexpr std::uint16_t kLifeGuardError = 0x8130;
/// Of 1014h: bit 31, the drive sends no EMCY; its CAN-ID has 11 bits.
constexpr std::uint32_t kNoEmergency = 0x8000'0000;

canopen::SdoServer::Options server_options(const drive::Rules& rules) {
  canopen::SdoServer::Options options;
  options.segmented = rules.sdo.segmented;
  options.block = rules.sdo.segmented && rules.sdo.block;
  options.echo = rules.sdo.echoes_data;
  return options;
}

/// These CAN-IDs are restricted (CiA 301, 7.3.5): no PDO, no EMCY and no SYNC has them.
bool is_sdo_of_other(const can::Frame& frame, std::uint8_t node) {
  if (frame.extended || frame.remote || frame.error) return false;
  const auto channel = frame.id & ~0x7FU;
  return (channel == canopen::kSdoRequest || channel == canopen::kSdoAnswer) && (frame.id & 0x7FU) != node;
}

}  // namespace

CanPort::CanPort(DriveModel& model)
    : model_(&model),
      server_(model.node(), model, server_options(model.profile().rules)),
      pdos_(model.profile(), model.values(), model),
      error_control_(model.node()) {
  model.attach(*this);
}

void CanPort::on_frame(const can::Frame& frame, TimePoint now) {
  model_->set_time(now);
  if (faults_.silent || boot_at_ != kNever) return;
  on_lss(frame, now);
  if (is_unconfigured() || is_sdo_of_other(frame, model_->node())) return;
  if (const auto message = canopen::parse_nmt(frame)) {
    if (message->node == 0 || message->node == model_->node()) on_nmt(message->command, now);
    return;
  }
  on_error_control(frame, now);
  if (nmt_ == NmtState::stopped) return;  // CiA 301, table 39: no SDO in this state.
  pdos_.on_frame(frame, now);
  if (pdos_.take_synchronous(objects::kInterpolationPoint)) model_->take_interpolation_point();
  collect_pdos(now);
  server_.on_frame(frame, now);
  collect_answers(now);
}

/// A drive that gets its first node-ID starts with it by itself (CiA 305, 4.2).
void CanPort::on_lss(const can::Frame& frame, TimePoint now) {
  if (!lss_) return;
  lss_->on_frame(frame);
  while (const auto answer = lss_->take_frame()) tx_.push_back(*answer);
  if (!lss_->take_start()) return;
  boots_ = Boot::reset_communication;
  boot_at_ = now + kBootTime;
}

/// A heartbeat that is watched, or the question of node guarding: then the master is there again.
void CanPort::on_error_control(const can::Frame& frame, TimePoint now) {
  consumer_.on_frame(frame, now);
  error_control_.on_frame(frame, now);
  bool guarded = false;
  for (auto answer = error_control_.take_frame(); answer; answer = error_control_.take_frame()) {
    tx_.push_back(*answer);
    guarded = true;
  }
  if (consumer_.take_found() || guarded) model_->end_error(ErrorLog::Source::master);
  collect_emergencies(now);
}

void CanPort::collect_pdos(TimePoint now) {
  collect_emergencies(now);
  while (const auto frame = pdos_.take_frame()) tx_.push_back(*frame);
  struct Row {
    ErrorLog::Source source;
    bool present;
    std::uint16_t code;
  };
  const Row rows[] = {{ErrorLog::Source::rpdo_short, pdos_.has_short_rpdo(), kPdoLengthError},
                      {ErrorLog::Source::rpdo_long, pdos_.has_long_rpdo(), kPdoLengthExceeded}};
  for (const auto& row : rows)
    if (!row.present) model_->end_error(row.source);
  for (const auto& row : rows)
    if (row.present && !model_->has_error(row.source)) model_->begin_error(row.source, row.code);
  collect_emergencies(now);
}

void CanPort::collect_answers(TimePoint now) {
  collect_emergencies(now);
  while (const auto answer = server_.take_frame()) answers_.put(*answer, faults_, now);
  while (const auto answer = answers_.take(now)) tx_.push_back(*answer);
}

void CanPort::on_time(TimePoint now) {
  collect_emergencies(now);
  if (now >= planned_silence_) {
    faults_.silent = true;
    planned_silence_ = kNever;
  }
  if (now >= boot_at_) boot(now);
  model_->on_time(now);
  collect_emergencies(now);
  if (consumer_.take_lost(now)) on_master_lost(now);
  pdos_.on_time(now);
  collect_pdos(now);
  server_.on_time(now);
  collect_answers(now);
  error_control_.on_time(now);
  while (const auto heartbeat = error_control_.take_frame()) tx_.push_back(*heartbeat);
  if (error_control_.take_life_lost()) on_life_lost(now);
  send_emergencies(now);
  if (faults_.silent) tx_.clear();
}

TimePoint CanPort::deadline() const {
  if (model_->has_emergency()) return TimePoint::min();
  return std::min({boot_at_, model_->deadline(), pdos_.deadline(), server_.deadline(),
                   error_control_.deadline(), consumer_.deadline(),
                   emergencies_.deadline(emergency_inhibit()), planned_silence_, answers_.deadline()});
}

std::optional<can::Frame> CanPort::take_frame() {
  if (tx_.empty()) return std::nullopt;
  const auto frame = tx_.front();
  tx_.pop_front();
  return frame;
}

std::uint32_t CanPort::check_write(ObjectAddress object, ByteSpan data) const {
  if (faults_.no_stop && object == objects::kControlword && drive::is_energised(model_->power_state()))
    return canopen::sdo_abort::kDeviceState;
  if (const auto code = CommunicationGuard(values()).check(object, data); code != 0) return code;
  return PdoGuard(model_->profile(), values()).check(object, data, nmt_ == NmtState::operational);
}

void CanPort::on_written(ObjectAddress object) {
  if (object == objects::kProducerHeartbeat || object == objects::kGuardTime ||
      object == objects::kLifeTimeFactor)
    set_up_error_control(model_->now());
  if (object.index == objects::kConsumerHeartbeatIndex && object.sub > 0)
    consumer_.set(object.sub, static_cast<std::uint32_t>(values().number(object)));
}

void CanPort::boot(TimePoint now) {
  boot_at_ = kNever;
  if (boots_ == Boot::power_on) {
    model_->power_on(now);
  } else if (boots_ == Boot::reset_node) {
    model_->reset_node(now);
  } else {
    if (lss_) model_->set_node(lss_->pending_node());
    model_->reset_communication(now);
  }
  if (lss_) lss_->restart();
  emergencies_ = {};
  if (is_unconfigured()) return pdos_.stop();
  server_ = canopen::SdoServer(model_->node(), *model_, server_options(rules()));
  const bool start = model_->setting(rules().nmt.autostart) == 1;
  nmt_ = start ? NmtState::operational : NmtState::pre_operational;
  model_->set_operational(start);
  error_control_ = canopen::ErrorControlSlave(model_->node());
  error_control_.boot(nmt_, now);
  tx_.push_back(*error_control_.take_frame());
  set_up_error_control(now);
  set_up_consumers();
  pdos_.stop();
  if (start) pdos_.start(now);
}

void CanPort::on_nmt(NmtCommand command, TimePoint now) {
  switch (command) {
    case NmtCommand::start: return set_nmt(NmtState::operational, now);
    case NmtCommand::stop: return set_nmt(NmtState::stopped, now);
    case NmtCommand::enter_pre_operational: return set_nmt(NmtState::pre_operational, now);
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      boots_ = command == NmtCommand::reset_node ? Boot::reset_node : Boot::reset_communication;
      boot_at_ = now + kBootTime;
      error_control_.stop();
      consumer_ = {};
      server_.reset();
      answers_.clear();
      set_nmt(NmtState::initialising, now);
  }
}

void CanPort::set_nmt(NmtState state, TimePoint now) {
  model_->set_operational(state == NmtState::operational);
  nmt_ = state;
  if (state == NmtState::stopped || state == NmtState::initialising) emergencies_.clear();
  error_control_.set_state(state);
  if (state == NmtState::operational)
    pdos_.start(now);
  else
    pdos_.stop();
  collect_emergencies(now);
}

void CanPort::set_up_error_control(TimePoint now) {
  error_control_.set_heartbeat(std::chrono::milliseconds(values().number(objects::kProducerHeartbeat)), now);
  error_control_.set_life_time(std::chrono::milliseconds(values().number(objects::kGuardTime)),
                               static_cast<std::uint32_t>(values().number(objects::kLifeTimeFactor)));
}

void CanPort::set_up_consumers() {
  for (std::uint8_t entry = 1; entry <= HeartbeatConsumer::kMost; ++entry) {
    const ObjectAddress object{objects::kConsumerHeartbeatIndex, entry};
    if (values().has(object)) consumer_.set(entry, static_cast<std::uint32_t>(values().number(object)));
  }
}

/// The master has stopped asking.
void CanPort::on_life_lost(TimePoint now) {
  const bool masked = model_->setting(rules().nmt.guarding_alarm) == 0;
  if (!masked) on_master_lost(now);
}

/// A heartbeat that 1016h watches, or the question of life guarding, has not come: what the drive does about
/// it, and the NMT state that 1029h names.
void CanPort::on_master_lost(TimePoint now) {
  model_->on_master_lost(kLifeGuardError, now);
  collect_emergencies(now);
  enter_error_state(now);
}

/// CiA 301, 7.5.2.32: from Operational to Pre-operational, also of a drive without the object.
void CanPort::enter_error_state(TimePoint now) {
  enum : std::uint64_t { kPreOperational, kNoChange, kStopped };
  const auto object = objects::kCommunicationErrorBehaviour;
  const auto behaviour = values().has(object) ? values().number(object) : kPreOperational;
  if (behaviour == kPreOperational && nmt_ == NmtState::operational) set_nmt(NmtState::pre_operational, now);
  if (behaviour == kStopped) set_nmt(NmtState::stopped, now);
}

void CanPort::collect_emergencies(TimePoint now) {
  while (const auto emergency = model_->take_emergency()) {
    queue(*emergency);
    send_emergencies(now);
  }
}

/// Under the COB-ID in 1014h, unless its bit 31 says that there is none; under that of the pre-defined
/// connection set where there is no such object, or it holds a CAN-ID that no emergency may have: 0 where the
/// EDS names no default is that of NMT.
void CanPort::queue(const Emergency& emergency) {
  if (nmt_ == NmtState::stopped || nmt_ == NmtState::initialising) return;
  const auto cob_id = static_cast<std::uint32_t>(values().number(objects::kEmergencyCobId));
  if ((cob_id & kNoEmergency) != 0) return;
  auto frame = canopen::emergency_frame({.node = model_->node(),
                                         .code = emergency.code,
                                         .error_register = emergency.error_register,
                                         .vendor = emergency.vendor,
                                         .size = rules().emergency.size});
  if (values().has(objects::kEmergencyCobId) && !canopen::is_restricted(cob_id & canopen::kCanId))
    frame.id = cob_id & canopen::kCanId;
  emergencies_.push(frame);
}

void CanPort::send_emergencies(TimePoint now) {
  while (const auto frame = emergencies_.take_frame(emergency_inhibit(), now)) tx_.push_back(*frame);
}

Duration CanPort::emergency_inhibit() const {
  return values().number(objects::kEmergencyInhibit) * std::chrono::microseconds(100);
}

}  // namespace servoctl::sim
