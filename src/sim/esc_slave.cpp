#include "sim/esc_slave.hpp"

#include <algorithm>
#include <utility>

#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::sim {
namespace {

/// How often its processor turns to the drive, and to what that gives; frames pass far more often.
constexpr Duration kRhythm = std::chrono::microseconds(250);
constexpr Duration kSampling = std::chrono::milliseconds(1);

}  // namespace

EscSlave::Options EscSlave::Options::of(const drive::Profile& profile) {
  Options out;
  out.coe.sdo_info = profile.rules.coe.sdo_info;
  out.coe.complete_access = profile.rules.coe.complete_access;
  return out;
}

EscSlave::EscSlave(const drive::Profile& profile, std::uint8_t node, Memory& memory, std::string key,
                   Options options)
    : model_(profile, node, memory, std::move(key)),
      process_data_(model_),
      coe_(model_, options.coe, faults_),
      mailbox_(registers().sync_manager(EscRegisters::kMailboxOut),
               registers().sync_manager(EscRegisters::kMailboxIn), coe_, faults_),
      states_(*this) {
  const auto index = [&](const std::string& name) {
    const auto found = drive::resolve(&profile, name);
    return found ? found->address.index : std::uint16_t{0};
  };
  assign_outputs_ = index(profile.rules.pdo.assign_rpdo);
  assign_inputs_ = index(profile.rules.pdo.assign_tpdo);
  model_.attach(*this);
  ObjectValues values(profile);
  values.load_defaults(node);
  registers().sii().mute = options.sii == SiiFault::mute;
  registers().sii().set_content(build_sii(profile, values, options.alias, options.sii));
}

void EscSlave::power_on(TimePoint now) {
  mailbox_.stop();
  states_.reset();
  request_.reset();
  outputs_seen_ = master_lost_ = false;
  registers().power_on(now);
  registers().set_al_status(states_.status(), states_.code());
  model_.power_on(now);
}

bool EscSlave::on_frame(std::span<std::uint8_t> frame, TimePoint now) {
  on_time(now);
  const Bytes before(frame.begin(), frame.end());
  if (!controller_.process(frame, now)) return false;
  falsify_process_data(frame, before, faults_);
  work(now);
  return true;
}

void EscSlave::on_time(TimePoint now) {
  if (now >= model_.deadline() || now - model_.now() >= kRhythm) model_.on_time(now);
  registers().on_time(now);
  if (registers().take_outputs_missed()) {
    outputs_seen_ = false;
    master_lost_ = true;
    if (state() == EscState::op) states_.fall_to(EscState::safe_op, al_code::kWatchdog);
    master_lost_ = false;
  }
  if (now >= fall_.time) {
    const auto fall = std::exchange(fall_, {});
    states_.fall_to(fall.to, fall.code);
  }
  lie(now);
  work(now);
}

void EscSlave::lie(TimePoint now) {
  if (lies_.words.empty()) return;
  if (!enabled_at_ && model_.power_state() == drive::DriveState::operation_enabled) enabled_at_ = now;
  if (!enabled_at_ || now < *enabled_at_ + lies_.after) return;
  if (!honest_) begin_to_lie();
  if (lies_.length && now >= *enabled_at_ + lies_.after + *lies_.length) end_lies();
}

void EscSlave::begin_to_lie() {
  honest_ = faults_;
  for (const auto word : lies_.words) {
    add_lie(faults_, word);
    Bytes shown;
    if (word == "statusword" && model_.read(objects::kStatusword, shown) == 0)
      model_.misbehaviour().statusword = static_cast<std::uint16_t>(load_le(shown));
    if (word == "mode") model_.misbehaviour().mode = std::int8_t{0};
  }
}

void EscSlave::end_lies() {
  lies_.words.clear();
  faults_ = *honest_;
  model_.misbehaviour().statusword.reset();
  model_.misbehaviour().mode.reset();
}

TimePoint EscSlave::deadline() const {
  const auto next = std::min(
      {model_.deadline(), registers().deadline(), states_.deadline(), mailbox_.deadline(), fall_.time});
  return request_ ? std::min(next, request_->due) : next;
}

/// What the processor of the slave does, whenever something has happened.
void EscSlave::work(TimePoint now) {
  if (registers().take_settings_changed()) states_.on_settings_changed();
  if (registers().take_outputs_written() && state() >= EscState::safe_op) {
    outputs_seen_ = true;
    if (state() == EscState::op) apply_outputs();
  }
  if (const auto control = registers().take_al_control())
    request_ = Request{*control, now + faults_.state_delay};
  if (request_ && now >= request_->due)
    states_.on_control(std::exchange(request_, std::nullopt)->control, now);
  states_.on_time(now);
  mailbox_.on_time(now);
  while (const auto emergency = model_.take_emergency()) mailbox_.push(EscCoe::emergency(*emergency), now);
  mailbox_.on_time(now);
  sample_inputs(now);
  show_state();
}

void EscSlave::show_state() {
  if (!faults_.frozen_state) registers().set_al_status(states_.status(), states_.code());
}

void EscSlave::apply_outputs() {
  const auto outputs = registers().sync_manager(EscRegisters::kOutputs).take();
  if (faults_.frozen_outputs) return;
  applies_ = true;
  process_data_.apply(outputs);
  applies_ = false;
  sampled_at_.reset();  // What they bring about is seen at once.
}

/// The first time on the way to SAFE-OP.
void EscSlave::sample_inputs(TimePoint now) {
  if (state() < EscState::safe_op) return sampled_at_.reset();
  if (sampled_at_ && now - *sampled_at_ < kSampling) return;
  sampled_at_ = now;
  if (faults_.frozen_inputs) return;
  registers().sync_manager(EscRegisters::kInputs).put(process_data_.sample());
}

}  // namespace servoctl::sim
