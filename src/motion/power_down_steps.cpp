// What each answer on a drive's way down leads to.
#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "motion/power.hpp"
#include "motion/power_down.hpp"

namespace servoctl::motion {
namespace {

using drive::DriveState;

/// A ramp of servoctl's own takes half a second.
constexpr Duration kHaltPatience = std::chrono::seconds(2);
/// After a halt has not helped, a quick stop has to soon.
constexpr Duration kShortQuickStop = std::chrono::seconds(1);
/// A drive that obeys has lost a tenth of its speed by then.
constexpr Duration kMostDownDelay = std::chrono::milliseconds(250);
constexpr double kSlower = 0.9;
constexpr int kTries = 3;
/// Bits 0 to 3 of 6040h: enable operation.
constexpr std::uint64_t kEnables = 0x000F;
constexpr int kOtherMeans = 2;
/// A motor at rest shows some noise: this part of its greatest speed.
constexpr double kStandstillPart = 50;

bool brakes(DriveState state) { return state == DriveState::fault_reaction_active; }

}  // namespace

void PowerDown::on_look(const Result<Bytes>& answer, TimePoint now) {
  const auto state = take_state(answer);
  // What cannot be looked at is stopped all the same.
  if (!answer) return enter(State::quick_stop, now);
  if (!drive::is_energised(state)) return enter(State::cut, now);
  if (state != DriveState::operation_enabled)
    return enter(brakes(state) ? State::cut : State::quick_stop, now);
  enter(plan_.gentle->halt ? State::halt : gently_ ? State::slowing : State::quick_stop, now);
}

void PowerDown::on_slowing(const Result<Bytes>& answer, TimePoint now) {
  const auto state = take_state(answer);
  if (!answer) return enter(State::quick_stop, now);
  if (drive::is_energised(state)) return poll_again(State::slowing_speed, TimePoint::min());
  result_.stopped = true;
  enter(State::cut, now);
}

void PowerDown::on_slowing_speed(const Result<Bytes>& answer, TimePoint now) {
  const auto speed = speed_in(answer);
  if (speed && *speed <= plan_.standstill) {
    result_.stopped = true;
    return after_stop(now);
  }
  if (speed && !first_speed_) first_speed_ = speed;
  const bool slower = speed && *speed < *first_speed_ * kSlower;
  if (now >= since_ + (slower ? kHaltPatience : kMostDownDelay)) return enter(State::quick_stop, now);
  poll_again(State::slowing, now);
}

void PowerDown::on_quick_stop(const Result<Bytes>& answer, TimePoint now) {
  result_.written = answer.has_value();
  if (!answer) untaken_ = answer.error().message.text();
  enter(State::stopping, now);
}

void PowerDown::on_stopping(const Result<Bytes>& answer, TimePoint now) {
  const auto state = take_state(answer);
  if (answer && plan_.aim == PowerAim::stop && !result_.found) result_.found = state;
  if (!answer) return after_stop(now);
  if (!drive::is_energised(state)) {
    result_.stopped = true;
    return after_stop(now);
  }
  // Refused, or ignored: there are other means, unless this is what was asked for.
  if (state != DriveState::quick_stop_active) standing_since_.reset();
  poll_again(State::stopping_speed, TimePoint::min());
}

/// By its speed, whatever unit that has; without one by bit 10 (CiA 402-2: a quick stop has ended at
/// standstill).
void PowerDown::on_stopping_speed(const Result<Bytes>& answer, TimePoint now) {
  const auto speed = speed_in(answer);
  if (speed) fastest_ = std::max(*speed, fastest_.value_or(*speed));
  const bool still = plan_.speed ? speed && *speed <= plan_.standstill
                     : speed     ? *speed <= std::floor(*fastest_ / kStandstillPart)
                     : has_seen_ ? (*result_.statusword & kTargetReached) != 0
                                 : false;
  const bool follows = has_seen_ && seen_ == DriveState::quick_stop_active;
  if ((!follows && !plan_.speed) || !still)
    standing_since_.reset();
  else if (!standing_since_)
    standing_since_ = now;
  // Most lose their power then by themselves; by 605Ah some stay.
  const auto enough = plan_.speed ? Duration::zero() : kPatience;
  if (standing_since_ && now - *standing_since_ >= enough) {
    result_.stopped = true;
    return after_stop(now);
  }
  if (now >= stop_since_.value_or(since_) + (plan_.gentle ? kShortQuickStop : kQuickStopPatience))
    return after_stop(now);
  poll_again(State::stopping, now);
}

void PowerDown::after_stop(TimePoint now) {
  if (plan_.aim == PowerAim::stop) {
    const bool fell_out = has_seen_ && !drive::is_energised(seen_);
    return fell_out && result_.written ? enter(State::holding, now) : end_stop();
  }
  // What turns is not let go gently.
  const bool gently =
      has_seen_ && seen_ == DriveState::operation_enabled && (result_.stopped || !plan_.gentle);
  tries_ = 0;
  enter(gently ? State::switch_off : State::cut, now);
}

void PowerDown::on_switch_off(const Result<Bytes>& answer, TimePoint now) {
  enter(answer ? State::switching_off : State::cut, now);
}

void PowerDown::on_switching_off(const Result<Bytes>& answer, TimePoint now) {
  const auto state = take_state(answer);
  if (answer && !result_.quick_stop && !result_.found) result_.found = state;
  if (!answer || state != DriveState::operation_enabled || now >= since_ + kPatience)
    return enter(State::cut, now);
  poll_again(State::switching_off, now);
}

void PowerDown::on_cut(const Result<Bytes>& answer, TimePoint now) {
  ++tries_;
  result_.written = answer.has_value();
  if (!answer) untaken_ = answer.error().message.text();
  enter(State::cutting, now);
}

void PowerDown::on_cutting(const Result<Bytes>& answer, TimePoint now) {
  const auto state = take_state(answer);
  if (answer && is_without_power(state)) {
    if (result_.written) return enter(State::holding, now);
    return tries_ >= kTries ? end_cut() : enter(State::cut, now);
  }
  if (answer && now < since_ + kPatience) return poll_again(State::cutting, now);
  if (answer && result_.written && !brakes(state)) ++result_.ignored;
  cut_again(now);
}

/// A drive without power that acknowledges a word and does not take it (another master commands it, or its
/// panel) keeps what starts it again. One that does not tell has acknowledged it, and that is all that is
/// known.
void PowerDown::on_holding(const Result<Bytes>& answer, TimePoint now) {
  const bool stops = plan_.aim == PowerAim::stop;
  const auto word = answer && answer->size() <= 2 ? load_le(*answer) : 0;
  const bool enables = (word & kEnables) == kEnables;
  if (enables) {
    result_.written = false;
    untaken_ = formatted("the write was acknowledged, but it still reads 0x{:04X}", word);
    if (++held_ < kTries) return enter(stops ? State::quick_stop : State::cut, now);
  }
  if (stops) return end_stop();
  end_cut();
}

/// In the end by another state (NMT on CAN): some families are disabled outside of Operational, others react
/// to "stop" by 6007h.
void PowerDown::cut_again(TimePoint now) {
  if (tries_ < kTries) return enter(State::cut, now);
  if ((has_seen_ && brakes(seen_)) || means_ >= kOtherMeans) return end_cut();
  back_to_ = State::cut;
  const auto state = means_ == 0 ? session::NodeState::pre_operational : last_state();
  result_.notes.push_back(formatted("it was sent {}, because it did not obey", order(state)));
  enter(means_++ == 0 ? State::wake : State::last_state, now);
}

/// In which neither objects nor process values are served.
session::NodeState PowerDown::last_state() const {
  const bool ring = plan_.network != nullptr && plan_.network->is_ring();
  return ring ? session::NodeState::initialising : session::NodeState::stopped;
}

std::string PowerDown::order(session::NodeState state) const {
  return plan_.network != nullptr ? plan_.network->state_order(state) : std::string(session::name(state));
}

std::optional<double> PowerDown::speed_in(const Result<Bytes>& answer) {
  if (!answer || answer->empty() || answer->size() > 4) return std::nullopt;
  if (plan_.speed) return plan_.speed(*answer);
  const auto bits = 64 - 8 * static_cast<int>(answer->size());
  return std::abs(static_cast<double>(static_cast<std::int64_t>(load_le(*answer) << bits) >> bits));
}

void PowerDown::end_stop() {
  if (unread_) return finish(fail(*unread_));
  const auto state = seen_;
  if (!drive::is_energised(state) && !result_.written) {
    return finish(
        fail(drive_error(Errc::negative, plan_.node,
                         message("is in {}, and 6040h did not accept {:04X}h ({}): it may restart by itself",
                                 drive::name(state), kQuickStopWord, untaken_),
                         "`disable` it, or switch off the supply")));
  }
  if (!drive::is_energised(state) || result_.stopped) return finish({});
  const bool followed = state == DriveState::quick_stop_active;
  finish(fail(drive_error(
      Errc::negative, plan_.node,
      followed ? std::string("is in quick stop active and does not report standstill")
               : message("does not follow the quick stop; it is in {} ({})", drive::name(state), word()),
      followed ? "check the motor; `disable` de-energises it"
               : "does another master control it? `disable`, or switch off the supply")));
}

void PowerDown::end_cut() {
  if (unread_) return finish(fail(*unread_));
  const auto state = seen_;
  if (is_without_power(state) && result_.written) return finish({});
  if (is_without_power(state))
    return finish(
        fail(drive_error(Errc::negative, plan_.node,
                         message("is in {}, and 6040h did not accept {:04X}h ({}): it may restart by itself",
                                 drive::name(state), kDisableVoltageWord, untaken_),
                         "switch off the supply before anybody approaches the machine")));
  if (brakes(state))
    return finish(
        fail(drive_error(Errc::negative, plan_.node, "is still braking after a fault, and may be energised",
                         "`status` shows its state")));
  finish(fail(drive_error(
      Errc::negative, plan_.node,
      message("does not obey 0000h, written {} times; it is in {} ({})", tries_, drive::name(state), word()),
      "does another master control it? Switch off the supply")));
}

void PowerDown::finish(Result<void> outcome) {
  result_.outcome = std::move(outcome);
  state_ = State::done;
}

}  // namespace servoctl::motion
