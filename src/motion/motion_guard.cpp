#include "motion/motion_guard.hpp"

#include <algorithm>
#include <span>
#include <tuple>

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/standard_objects.hpp"
#include "motion/operation_mode.hpp"

namespace servoctl::motion {
namespace {

using drive::DriveState;

constexpr std::uint8_t kQuickStop = 0x02;
constexpr std::uint8_t kDisableVoltage = 0x00;

constexpr std::uint32_t kLife = 5;  ///< Guard times in the life time.

}  // namespace

MotionGuard::MotionGuard(session::Session& session, const MotionUnits& units, std::uint8_t node)
    : session_(&session),
      units_(&units),
      node_(node),
      power_(session, units.profile(), node),
      hold_(session.protect(session::Care::guarded)),
      foreign_writes_(session, node, [this](auto object, auto way) { hear_write(object, way); }) {}

/// Where even the way out runs out of memory, the drive is still told to stop: nothing of that needs any.
MotionGuard::~MotionGuard() {
  try {
    (void)end();
  } catch (...) {
    if (rehearsal_ != nullptr) return;
    for (const auto controlword : {kQuickStop, kDisableVoltage, kDisableVoltage}) say(controlword);
  }
}

void MotionGuard::say(std::uint8_t controlword) noexcept {
  session_->network().send_last_word(node_, objects::kControlword, controlword);
}

namespace {

/// By which its targets may come.
bool is_of_an_rpdo(ObjectAddress object) {
  const auto place = pdo_at(object.index);
  return place && place->direction == PdoDirection::receive;
}

}  // namespace

void MotionGuard::hear_write(ObjectAddress object, session::ForeignWrites::Way way) {
  if (end_) return;
  if (object == objects::kControlword || own_.count(object) > 0 || is_of_an_rpdo(object))
    foreign_.emplace(object, way);
}

std::optional<MotionGuard::ForeignCommand> MotionGuard::foreign_command() const {
  for (const auto object : {objects::kControlword, objects::kModeOfOperation, objects::kTargetVelocity,
                            objects::kTargetPosition, objects::kTargetTorque})
    if (const auto found = foreign_.find(object); found != foreign_.end())
      return ForeignCommand{object, found->second};
  for (const auto& [object, way] : foreign_)
    if (is_of_an_rpdo(object)) return ForeignCommand{object, way};
  return std::nullopt;
}

Result<void> MotionGuard::change(ObjectAddress object, const Bytes& data) {
  own_.insert(object);
  const auto* rehearsed = rehearsal_ != nullptr ? rehearsal_->held(object) : nullptr;
  if (rehearsed != nullptr && *rehearsed == data) return {};
  const bool known =
      std::any_of(changed_.begin(), changed_.end(), [&](const Changed& c) { return c.object == object; });
  if (known) return write(object, data);
  const session::SdoRequest asked{.node = node_, .object = object, .size = data.size()};
  const auto before = session_->transfer(std::span(&asked, 1)).front();
  if (!before) return fail(before.error());
  // A drive may cut a longer number, and would turn at another speed.
  if (before->size() != data.size())
    return fail(drive_error(
        Errc::refused, node_, object,
        message("has {} bytes in this drive, not {} as its data say", before->size(), data.size()),
        "the data are those of another drive or firmware; the motor was not moved"));
  if (rehearsed == nullptr && *before == data) return {};
  // Noted first: an answer that is lost may belong to a write that was done.
  changed_.push_back({object, *before});
  return write(object, data);
}

Result<void> MotionGuard::write(ObjectAddress object, const Bytes& data) {
  if (rehearsal_ == nullptr) return session_->download(node_, object, data);
  rehearsal_->add(session::planned_write({node_, object, data}));
  return {};
}

Result<void> MotionGuard::change_mode(std::int8_t mode) {
  // 6061h may show another one: a drive starts in none and has one waiting.
  const auto before = session_->upload(node_, objects::kModeOfOperation);
  if (!before) return fail(before.error());
  changed_.push_back({objects::kModeOfOperation, *before});
  own_.insert(objects::kModeOfOperation);
  mode_ = mode;
  if (rehearsal_ != nullptr) {
    const auto planned = mode_write(units_->profile(), node_, mode);
    return write(planned.object, *planned.data);
  }
  return set_mode(*session_, units_->profile(), node_, mode);
}

Result<void> MotionGuard::neutral_targets(std::optional<ObjectAddress> except) {
  for (const auto object : {objects::kTargetVelocity, objects::kTargetTorque}) {
    if (!units_->has(object) || object == except) continue;
    const auto size = od::size_of(units_->meaning(object).type).value_or(4);
    const auto done = change(object, Bytes(size, 0));
    // The dictionary may promise more than the drive has.
    if (!done && done.error().abort_code != canopen::sdo_abort::kNoObject) return done;
  }
  if (!units_->has(objects::kTargetPosition) || !units_->has(objects::kPositionActual)) return {};
  const auto here = session_->upload(node_, objects::kPositionActual);
  if (!here) return fail(here.error());
  return change(objects::kTargetPosition, *here);
}

Result<void> MotionGuard::arm(const WatchdogPlan& plan) {
  watchdog_ = plan;
  if (plan.reaction_off)
    if (const auto done = change(objects::kAbortConnectionOption, store_le(kReactWithFault, 2)); !done)
      return done;
  const auto ms =
      static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(plan.time).count());
  if (plan.kind == WatchdogPlan::Kind::heartbeat) {
    if (const auto done = change({objects::kConsumerHeartbeatIndex, plan.entry},
                                 store_le(std::uint32_t{plan.producer} << 16U | ms, 4));
        !done)
      return done;
    const session::LifeSign sign{session::LifeSign::Kind::heartbeat, plan.producer, plan.time / kLife};
    if (auto sent = send_life_sign(sign); !sent) return sent;
  }
  if (plan.kind == WatchdogPlan::Kind::guarding) {
    for (const auto& [object, value, size] :
         {std::tuple{objects::kGuardTime, ms / kLife, 2U}, std::tuple{objects::kLifeTimeFactor, kLife, 1U}})
      if (const auto done = change(object, store_le(value, size)); !done) return done;
    const session::LifeSign sign{session::LifeSign::Kind::guarding, 0, plan.time / kLife, kLife};
    if (auto sent = send_life_sign(sign); !sent) return sent;
  }
  if (plan.kind == WatchdogPlan::Kind::sync_manager)
    if (auto sent = send_life_sign({session::LifeSign::Kind::process_data, 0, plan.time}); !sent) return sent;
  armed_ = plan.kind != WatchdogPlan::Kind::none;
  if (plan.kind == WatchdogPlan::Kind::sync_manager || rehearsal_ != nullptr) return {};
  // The drive watches from the first message on.
  return pause(*session_, Duration::zero());
}

Result<void> MotionGuard::send_life_sign(const session::LifeSign& sign) {
  if (rehearsal_ == nullptr) return session_->network().arm_watchdog(node_, sign);
  rehearsal_->add(session::planned_life_sign(node_, sign));
  return {};
}

Result<void> MotionGuard::spare_flash() {
  const auto& store = units_->profile().rules.store;
  const auto object = units_->object(store.flash_switch);
  if (!object || !store.to_ram) return {};
  const auto data = od::encode(units_->meaning(*object).type, od::Value(*store.to_ram));
  if (!data) return fail(data.error());
  return change(*object, *data);
}

bool MotionGuard::needs_process_data() const {
  return session_->network().carries(session::LifeSign::Kind::process_data);
}

Result<void> MotionGuard::start_node() {
  state_before_ = session_->watch().state(node_);
  const bool needed = needs_process_data() || units_->profile().rules.nmt.disables_outside_operational;
  held_before_ = needs_process_data() && state_before_ == session::NodeState::operational;
  if (!needed || state_before_ == session::NodeState::operational) return {};
  started_ = true;
  if (rehearsal_ != nullptr) {
    rehearsal_->add(session::planned_state(node_, session::NodeState::operational));
    return {};
  }
  if (auto sent = session_->network().request_state(node_, session::NodeState::operational); !sent)
    return sent;
  if (needs_process_data()) return wait_until_awake();
  return pause(*session_, kRequestPause);
}

/// Some drives begin to run their state machine in OP. One that stays "not ready to switch on" is refused
/// when it is to be enabled.
Result<void> MotionGuard::wait_until_awake() {
  const auto end = session_->now() + Power::kPatience;
  for (;;) {
    const auto state = power_.state();
    if (!state) return fail(state.error());
    if (*state != DriveState::not_ready_to_switch_on || session_->now() >= end) return {};
    if (auto paused = pause(*session_, kRequestPause); !paused) return paused;
  }
}

Result<void> MotionGuard::enable() {
  const auto state = power_.state();
  if (!state) return fail(state.error());
  if (drive::is_energised(*state)) {
    powered_ = true;
    return fail(enabled_by_others(node_, *state));
  }
  if (const auto foreign = foreign_command())
    return fail(Errc::negative,
                foreign->by_pdo()
                    ? message("another master sends PDOs with object {}: the drive was not enabled",
                              to_string(foreign->object))
                    : message("another master has written object {}: the drive was not enabled",
                              to_string(foreign->object)),
                std::string(kTwoMasters));
  energised_ = true;
  if (rehearsal_ == nullptr) return power_.reach(DriveState::operation_enabled);
  const auto path = power_.path_to(*state, DriveState::operation_enabled);
  if (!path) return fail(path.error());
  rehearse_up(*path);
  return {};
}

}  // namespace servoctl::motion
