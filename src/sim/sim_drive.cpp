#include "sim/sim_drive.hpp"

#include <algorithm>
#include <utility>

#include "canopen/cob_id.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::sim {
using canopen::NmtCommand;
using canopen::NmtState;

namespace {

/// From a reset to the boot-up message.
constexpr Duration kBootTime = std::chrono::milliseconds(50);
/// CiA 402-2, table of error codes.
constexpr std::uint16_t kFollowingErrorFault = 0x8611;
/// EMCY of an RPDO that was too short to be taken, and of one of which the first bytes were (CiA 301, table
/// 26).
constexpr std::uint16_t kPdoLengthError = 0x8210;
constexpr std::uint16_t kPdoLengthExceeded = 0x8220;

canopen::SdoServer::Options server_options(const drive::Rules& rules) {
  canopen::SdoServer::Options options;
  options.segmented = rules.sdo.segmented;
  options.block = rules.sdo.segmented && rules.sdo.block;
  options.echo = rules.sdo.echoes_data;
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
      axis_(profile, values_),
      server_(node, *this, server_options(profile.rules)),
      pdos_(profile, values_, *this),
      error_control_(node) {
  auto& cells = memory_->cells(key_);
  const auto node_id = drive::place_of(profile, profile.rules.nmt.node_id);
  const auto* entry = node_id ? profile.dictionary.find(*node_id) : nullptr;
  if (entry == nullptr || cells.find(*node_id) != cells.end()) return;
  if (!entry->default_value || od::to_double(entry->default_value->value) != node)
    cells[*node_id] = store_le(node, od::size_of(entry->type).value_or(1));
}

void SimDrive::on_frame(const can::Frame& frame, TimePoint now) {
  now_ = now;
  if (misbehaviour_.silent || boot_at_ != kNever) return;
  if (const auto message = canopen::parse_nmt(frame)) {
    if (message->node == 0 || message->node == node_) on_nmt(message->command, now);
    return;
  }
  consumer_.on_frame(frame, now);
  error_control_.on_frame(frame, now);
  bool guarded = false;
  for (auto answer = error_control_.take_frame(); answer; answer = error_control_.take_frame()) {
    tx_.push_back(*answer);
    guarded = true;
  }
  if (consumer_.take_found() || guarded) end_error(ErrorLog::Source::master);
  if (nmt_ == NmtState::stopped) return;  // CiA 301, table 39: no SDO in this state.
  pdos_.on_frame(frame, now);
  collect_pdos();
  server_.on_frame(frame, now);
  collect_answers(now);
}

void SimDrive::collect_pdos() {
  while (const auto frame = pdos_.take_frame()) tx_.push_back(*frame);
  struct Row {
    ErrorLog::Source source;
    bool present;
    std::uint16_t code;
  };
  const Row rows[] = {{ErrorLog::Source::rpdo_short, pdos_.has_short_rpdo(), kPdoLengthError},
                      {ErrorLog::Source::rpdo_long, pdos_.has_long_rpdo(), kPdoLengthExceeded}};
  for (const auto& row : rows)
    if (!row.present) end_error(row.source);
  for (const auto& row : rows)
    if (row.present && !errors_.is_present(row.source)) begin_error(row.source, row.code, {});
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
  if (now >= boot_at_) power_on(now);
  power_.on_time(now);
  move_axis();
  if (consumer_.take_lost(now)) on_master_lost(now);
  pdos_.on_time(now);
  collect_pdos();
  server_.on_time(now);
  collect_answers(now);
  while (!late_.empty() && now >= late_.front().time) {
    tx_.push_back(late_.front().frame);
    late_.pop_front();
  }
  error_control_.on_time(now);
  while (const auto heartbeat = error_control_.take_frame()) tx_.push_back(*heartbeat);
  if (error_control_.take_life_lost()) on_life_lost(now);
  if (planned_fault_ && now >= planned_fault_->time) {
    const auto alarm = std::exchange(planned_fault_, std::nullopt)->alarm;
    raise_fault(alarm.code, alarm.vendor, now);
  }
  collect_emergencies();
  if (misbehaviour_.silent) tx_.clear();
}

TimePoint SimDrive::deadline() const {
  auto next =
      std::min({boot_at_, power_.deadline(), pdos_.deadline(), server_.deadline(), error_control_.deadline(),
                consumer_.deadline(), emergencies_.deadline(emergency_inhibit()), planned_silence_});
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
  if (full_restart_)
    load_values(now);
  else
    load_communication_area();
  for (const auto source :
       {ErrorLog::Source::rpdo_short, ErrorLog::Source::rpdo_long, ErrorLog::Source::master})
    errors_.end(source);
  emergencies_ = {};
  values_.set_number(objects::kErrorRegister, errors_.error_register());
  load_mirrors();
  server_ = canopen::SdoServer(node_, *this, server_options(profile_->rules));
  const auto* autostart = parameter(profile_->rules.nmt.autostart);
  const bool start = autostart != nullptr && autostart->object && effective(*autostart->object) == 1;
  nmt_ = start ? NmtState::operational : NmtState::pre_operational;
  error_control_ = canopen::ErrorControlSlave(node_);
  error_control_.boot(nmt_, now);
  tx_.push_back(*error_control_.take_frame());
  set_up_error_control(now);
  set_up_consumers();
  pdos_.stop();
  if (start) pdos_.start(now);
}

/// What a drive has when its power comes.
void SimDrive::load_values(TimePoint now) {
  const auto load = [this] {
    values_.load_defaults(node_);
    for (const auto& cell : memory_->cells(key_)) values_.set(cell.first, cell.second);
  };
  restore_if_asked();
  load();
  if (const auto node_id = drive::place_of(*profile_, profile_->rules.nmt.node_id)) {
    const auto set_to = values_.number(*node_id);
    if (set_to >= canopen::kFirstNode && set_to <= canopen::kLastNode && set_to != node_) {
      node_ = static_cast<std::uint8_t>(set_to);
      load();
    }
  }
  at_start_.clear();
  for (const auto& p : profile_->parameters)
    if (p.object && p.effect == od::Effect::restart) at_start_[*p.object] = values_.number(*p.object);
  power_.reset();
  axis_.reset(now);
  errors_ = {};
  errors_.set_capacity(values_.last_sub(objects::kErrorHistory.index));
  fault_ = nullptr;
}

/// 1000h to 1FFFh as they are after power-on: what was stored, else the defaults (CiA 301, 7.3.2.2.1).
void SimDrive::load_communication_area() {
  values_.load_communication_defaults(node_);
  for (const auto& cell : memory_->cells(key_))
    if (in_communication_area(cell.first.index)) values_.set(cell.first, cell.second);
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
      set_nmt(NmtState::initialising);
  }
}

void SimDrive::set_nmt(NmtState state) {
  const bool leaves = nmt_ == NmtState::operational && state != NmtState::operational;
  if (leaves && profile_->rules.nmt.disables_outside_operational) power_.disable();
  nmt_ = state;
  if (state == NmtState::stopped || state == NmtState::initialising) emergencies_.clear();
  error_control_.set_state(state);
  if (state == NmtState::operational)
    pdos_.start(now_);
  else
    pdos_.stop();
}

void SimDrive::set_up_error_control(TimePoint now) {
  error_control_.set_heartbeat(std::chrono::milliseconds(values_.number(objects::kProducerHeartbeat)), now);
  error_control_.set_life_time(std::chrono::milliseconds(values_.number(objects::kGuardTime)),
                               static_cast<std::uint32_t>(values_.number(objects::kLifeTimeFactor)));
}

void SimDrive::set_up_consumers() {
  for (std::uint8_t entry = 1; entry <= HeartbeatConsumer::kMost; ++entry)
    if (values_.has({objects::kConsumerHeartbeatIndex, entry}))
      consumer_.set(entry,
                    static_cast<std::uint32_t>(values_.number({objects::kConsumerHeartbeatIndex, entry})));
}

/// Lets the axis move up to now; it cannot follow for long without a fault.
void SimDrive::move_axis() {
  axis_.advance(is_enabled(), now_);
  if (!is_enabled() || !axis_.has_following_error()) return;
  if (!raise_alarm(profile_->rules.fault.following_alarm)) raise_fault(kFollowingErrorFault, {}, now_);
}

/// The master has stopped asking.
void SimDrive::on_life_lost(TimePoint now) {
  const auto* alarm = parameter(profile_->rules.nmt.guarding_alarm);
  const bool masked = alarm != nullptr && alarm->object && effective(*alarm->object) == 0;
  if (!masked) on_master_lost(now);
}

}  // namespace servoctl::sim
