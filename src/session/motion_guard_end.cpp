// How a motion ends: the way down to a drive without power that is as it was.
#include <fmt/format.h>
#include <cmath>
#include <utility>

#include "drive/standard_objects.hpp"
#include "session/deaf.hpp"
#include "session/hurry.hpp"
#include "session/motion_guard.hpp"
#include "session/operation_mode.hpp"

namespace servoctl::session {
namespace {

using drive::DriveState;

constexpr std::uint16_t kHalted = 0x010F;
constexpr std::uint16_t kQuickStop = 0x0002;
constexpr std::uint16_t kDisableVoltage = 0x0000;

/// A ramp of servoctl's own takes half a second.
constexpr Duration kHaltPatience = std::chrono::seconds(2);
constexpr Duration kQuickStopPatience = std::chrono::seconds(1);
/// A drive that obeys has lost a tenth of its speed by then.
constexpr Duration kMostDelay = std::chrono::milliseconds(250);
constexpr double kSlower = 0.9;
constexpr Duration kPause = std::chrono::milliseconds(10);
constexpr int kTries = 3;
/// Longest wait for one answer while it is stopped: a drive that is lost is left to its own watchdog soon.
constexpr Duration kPatience = std::chrono::milliseconds(200);

bool is_lost(const Error& error) { return error.code == Errc::timeout || error.code == Errc::bus; }

bool is_without_power(DriveState state) {
  return !drive::is_energised(state) && state != DriveState::switched_on &&
         state != DriveState::ready_to_switch_on;
}

}  // namespace

/// Where it is not known in which state it was, it is not taken out of another master's hands.
void MotionGuard::put_node_back() {
  if (!std::exchange(started_, false)) return;
  if (!nmt_before_) {
    result_.notes.emplace_back(
        "the node was started (NMT) and stays operational: its state before is not known");
    return;
  }
  const auto sent = session_->send(canopen::nmt_frame(canopen::NmtCommand::enter_pre_operational, node_));
  if (!sent) note("the node could not be put back to pre-operational", sent.error());
}

Result<bool> MotionGuard::wait_for_standstill(Duration patience) {
  const auto begin = session_->now();
  std::optional<double> first;
  for (;;) {
    const auto state = power_.state();
    if (!state) return tl::unexpected<Error>(state.error());
    if (!drive::is_energised(*state)) return true;
    const auto answer = session_->upload(node_, objects::kVelocityActual);
    if (!answer && is_lost(answer.error())) return tl::unexpected<Error>(answer.error());
    const auto speed = answer ? units_->physical(objects::kVelocityActual, *answer) : std::nullopt;
    if (speed && std::abs(speed->value) <= standstill_.value_or(0)) return true;
    if (speed && !first) first = std::abs(speed->value);
    const bool slower = speed && std::abs(speed->value) < *first * kSlower;
    if (session_->now() >= begin + (slower ? patience : kMostDelay)) return false;
    if (const auto paused = pause(*session_, kPause); !paused) return tl::unexpected<Error>(paused.error());
  }
}

/// Halt where there is one, targets to zero, and a quick stop when that does not help.
void MotionGuard::stop() {
  const auto state = power_.state();
  if (!state) {
    lost_ = is_lost(state.error());
    return;
  }
  if (!drive::is_energised(*state)) return;
  const auto& rules = units_->profile().rules.motion;
  const auto mode = read_mode(*session_, node_);
  const bool by_target = mode && (*mode == rules.velocity || *mode == rules.torque);
  if (*state == DriveState::operation_enabled) {
    if (rules.halt) (void)power_.command(kHalted);
    const auto target = mode && *mode == rules.torque ? objects::kTargetTorque : objects::kTargetVelocity;
    if (by_target) {
      const auto size = od::size_of(units_->meaning(target).type).value_or(4);
      (void)session_->download(node_, target, Bytes(size, 0));
    }
  }
  auto stopped = rules.halt || by_target ? wait_for_standstill(kHaltPatience) : Result<bool>(false);
  if (stopped && !*stopped) {
    result_.quick_stop = true;
    (void)power_.command(kQuickStop);
    stopped = wait_for_standstill(kQuickStopPatience);
  }
  result_.stopped = stopped.value_or(false);
  lost_ = !stopped && is_lost(stopped.error());
}

/// By "switched on", so that the drive can set its brake; at once where it does not follow.
bool MotionGuard::take_power_away() {
  if (!lost_ && result_.stopped && power_.state() == DriveState::operation_enabled)
    (void)power_.reach(DriveState::switched_on);
  for (int i = 0; i < kTries; ++i) {
    const auto state = power_.state();
    if (state && is_without_power(*state)) return true;
    const auto written = power_.command(kDisableVoltage);
    if (written && power_.wait_for(DriveState::switch_on_disabled).value_or(false)) return true;
    if (!written && written.error().code == Errc::bus) return false;
  }
  const auto state = power_.state();
  return state && !drive::is_energised(*state);
}

void MotionGuard::note(const std::string& what, const Error& error) {
  result_.left.push_back(fmt::format("{}: {}", what, error.message));
}

void MotionGuard::put_back() {
  for (auto changed = changed_.rbegin(); changed != changed_.rend(); ++changed) {
    // Its old targets and an old watchdog are nothing for a drive that still has its power.
    if (lost_ || powered_) {
      result_.left.push_back(fmt::format("object {} was not put back to {}", to_string(changed->object),
                                         to_hex(changed->before)));
      continue;
    }
    const auto meaning = units_->meaning(changed->object);
    const auto value = od::decode(meaning.type, changed->before);
    if (meaning.type_known && value && !drive::check_limits(meaning, *value)) {
      // Some drives take a refused write for a fault.
      result_.notes.push_back(
          fmt::format("object {} keeps its new value: the one before, {}, is out of its range",
                      to_string(changed->object), to_hex(changed->before)));
      continue;
    }
    const auto done = session_->download(node_, changed->object, changed->before);
    if (!done)
      note(fmt::format("object {} could not be put back to {}", to_string(changed->object),
                       to_hex(changed->before)),
           done.error());
    lost_ = lost_ || (!done && is_lost(done.error()));
  }
  changed_.clear();
}

void MotionGuard::disarm() {
  if (!watchdog_) return;
  session_->stop_heartbeat();
  if (watchdog_->kind == WatchdogPlan::Kind::guarding) session_->stop_guarding();
  watchdog_.reset();
}

void MotionGuard::verify() {
  const auto end = session_->now() + Power::kPatience;
  for (;;) {
    const auto word = power_.statusword();
    if (!word) return note("the statusword could not be read", word.error());
    result_.statusword = *word;
    result_.state = drive::decode_state(*word);
    result_.verified = !drive::is_energised(result_.state);
    // A fault reaction takes its time.
    if (result_.verified || session_->now() >= end || !pause(*session_, kPause)) return;
  }
}

MotionEnd MotionGuard::end() {
  if (end_) return *end_;
  const Deaf deaf(*session_);
  if (energised_) {
    const Hurry hurry(*session_, kPatience, 1);
    stop();
    // A drive that cannot be reached is left to its own watchdog.
    if (lost_) disarm();
    powered_ = !take_power_away();
    // Some lose it when they leave Operational.
    if (powered_) put_node_back();
    if (powered_) powered_ = drive::is_energised(power_.state().value_or(DriveState::operation_enabled));
  }
  put_back();
  put_node_back();
  disarm();
  verify();
  if (!result_.verified) session_->energised().insert(node_);
  end_ = result_;
  if (session_->options().protect) session_->options().protect(false);
  return *end_;
}

Result<void> MotionGuard::release() {
  const Deaf deaf(*session_);
  Result<void> done;
  for (const auto& changed : changed_) {
    if (changed.object.index < 0x1000 || changed.object.index >= 0x2000) continue;
    done = session_->download(node_, changed.object, changed.before);
  }
  disarm();
  changed_.clear();
  energised_ = false;
  session_->energised().insert(node_);
  result_.state = power_.state().value_or(DriveState::unknown);
  end_ = result_;
  if (session_->options().protect) session_->options().protect(false);
  return done;
}

}  // namespace servoctl::session
