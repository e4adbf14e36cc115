#include "motion/power_down.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/standard_objects.hpp"
#include "motion/kept_op.hpp"
#include "motion/power.hpp"
#include "session/link_wait.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {
namespace {

using drive::DriveState;

constexpr Duration kStepPause = std::chrono::milliseconds(5);
/// Two cycles of a ring: each word is sent before the next one takes its place.
constexpr Duration kWordPause = std::chrono::milliseconds(10);
/// Answers that do not come before a drive is given up. A write that is acknowledged is no such answer: it
/// says nothing about the state.
constexpr int kMostSilences = 4;
/// On a ring: target 0, 02h twice, 07h and 00h, and 00h again after the exchange was ended.
constexpr int kMostSilencesOnRing = 6;
/// Where there may be no drive at all.
constexpr int kFewSilences = 2;
/// A message that names so many nodes is read by nobody.
constexpr std::size_t kMostNamed = 32;

}  // namespace

bool is_without_power(DriveState state) {
  return !drive::is_energised(state) && state != DriveState::switched_on &&
         state != DriveState::ready_to_switch_on;
}

DriveState PowerDownResult::state() const {
  return statusword ? drive::decode_state(*statusword) : DriveState::unknown;
}

std::optional<bool> PowerDownResult::had_power() const {
  if (!found || *found == DriveState::unknown || *found == DriveState::switched_on) return std::nullopt;
  if (drive::is_energised(*found)) return true;
  if (quick_stop) return std::nullopt;
  return false;
}

bool PowerDownResult::is_without_power() const { return motion::is_without_power(state()); }

PowerDown::PowerDown(PowerDownPlan plan) : plan_(std::move(plan)) { begin(); }

void PowerDown::begin() {
  state_ = plan_.gentle                     ? (plan_.gentle->zero_target ? State::zero_target : State::look)
           : plan_.aim == PowerAim::disable ? State::switch_off
                                            : State::quick_stop;
  pause_ = TimePoint::min();
  has_seen_ = gently_ = woken_ = stopped_again_ = false;
  silences_ = 0;
  tries_ = means_ = held_ = 0;
  begun_.reset();
  stop_since_.reset();
  first_speed_.reset();
  standing_since_.reset();
  untaken_ = "no answer";
  unread_.reset();
}

void PowerDown::on_bus_back() { begin(); }

std::optional<session::SdoRequest> PowerDown::last_word() const {
  return command(plan_.aim == PowerAim::stop ? kQuickStopWord : kDisableVoltageWord);
}

void PowerDown::on_end(const Error& error) {
  result_.statusword.reset();
  result_.written = false;
  result_.silent = true;
  finish(fail(error));
}

session::SdoRequest PowerDown::command(std::uint16_t controlword) const {
  return {plan_.node, objects::kControlword, store_le(controlword, 2)};
}

session::SdoRequest PowerDown::read(ObjectAddress object) const {
  return {.node = plan_.node, .object = object};
}

/// Of the statusword, for messages.
std::string PowerDown::word() const {
  return result_.statusword ? formatted("statusword 0x{:04X}", *result_.statusword)
                            : std::string("its statusword was not read");
}

DialogueStep PowerDown::next(TimePoint now) {
  if (!begun_) begun_ = now;
  if (state_ != State::done && now >= *begun_ + kLongest)
    plan_.aim == PowerAim::stop ? end_stop() : end_cut();
  if (now < pause_ && state_ != State::done) return {.pause = pause_};
  switch (state_) {
    case State::look:
    case State::slowing:
    case State::stopping:
    case State::switching_off:
    case State::cutting: return {.request = read(objects::kStatusword)};
    case State::holding: return {.request = read(objects::kControlword)};
    case State::halt: return {.request = command(kHalted)};
    case State::zero_target: return {.request = *plan_.gentle->zero_target};
    case State::slowing_speed:
    case State::stopping_speed: return {.request = read(objects::kVelocityActual)};
    case State::quick_stop:
      result_.quick_stop = true;
      if (!stop_since_) stop_since_ = now;
      return {.request = command(kQuickStopWord)};
    case State::switch_off: return {.request = command(kSwitchOffWord)};
    case State::cut: return {.request = command(kDisableVoltageWord)};
    case State::last_state:
      state_ = State::wake_again;
      return {.state = last_state(), .pause = now + kRequestPause};
    case State::wake:
    case State::wake_again:
      enter(back_to_, now);
      return {.state = session::NodeState::pre_operational, .pause = now + kRequestPause};
    case State::done: break;
  }
  return {.done = true};
}

void PowerDown::on_answer(Result<Bytes> answer, TimePoint now) {
  if (!answer && answer.error().code == Errc::timeout) return on_silence(answer.error(), now);
  const bool is_read = state_ == State::look || state_ == State::slowing || state_ == State::slowing_speed ||
                       state_ == State::stopping || state_ == State::stopping_speed ||
                       state_ == State::switching_off || state_ == State::cutting || state_ == State::holding;
  if (is_read) silences_ = 0;
  plan_.may_be_absent = false;
  switch (state_) {
    case State::zero_target: gently_ = answer.has_value(); return enter(State::look, now);
    case State::look: return on_look(answer, now);
    case State::halt:
      gently_ = gently_ || answer.has_value();
      return enter(gently_ ? State::slowing : State::quick_stop, now);
    case State::slowing: return on_slowing(answer, now);
    case State::slowing_speed: return on_slowing_speed(answer, now);
    case State::quick_stop: return on_quick_stop(answer, now);
    case State::stopping: return on_stopping(answer, now);
    case State::stopping_speed: return on_stopping_speed(answer, now);
    case State::switch_off: return on_switch_off(answer, now);
    case State::switching_off: return on_switching_off(answer, now);
    case State::cut: return on_cut(answer, now);
    case State::cutting: return on_cutting(answer, now);
    case State::holding: return on_holding(answer, now);
    case State::wake:
    case State::last_state:
    case State::wake_again:
    case State::done: return;
  }
}

void PowerDown::enter(State state, TimePoint now) {
  state_ = state;
  since_ = now;
}

/// Without taking the time anew.
void PowerDown::poll_again(State state, TimePoint now) {
  state_ = state;
  pause_ = now + kStepPause;
}

bool PowerDown::is_on_ring() const { return plan_.network != nullptr && plan_.network->is_ring(); }

void PowerDown::end_silent(const Error& error) {
  result_.silent = true;
  result_.written = false;
  unread_ = error;
  result_.statusword.reset();
  finish(fail(error));
}

/// An answer may be lost, so it is asked again, after the word that stops the motor. Then the node may be one
/// that was sent NMT "stop": it answers no SDO. What is dead at last has been sent the commands all the same.
void PowerDown::on_silence(const Error& error, TimePoint now) {
  ++silences_;
  const bool leaves_exchange = is_on_ring() && plan_.aim != PowerAim::stop && !plan_.may_be_absent;
  const int most = plan_.may_be_absent ? kFewSilences : leaves_exchange ? kMostSilencesOnRing : kMostSilences;
  if (silences_ >= most) {
    if (!is_on_ring() && !std::exchange(told_silence_, true) && plan_.on_silence) plan_.on_silence();
    return end_silent(error);
  }
  if (leaves_exchange) return go_on_blindly(now);
  const bool cutting = state_ >= State::switch_off && plan_.aim != PowerAim::stop;
  const bool may_turn = state_ <= State::slowing_speed && !gently_;
  if (state_ == State::zero_target)
    state_ = State::look;
  else if (may_turn || state_ == State::stopping)
    state_ = State::quick_stop;
  else if (state_ == State::cutting)
    state_ = State::cut;
  if (silences_ == 1 && !plan_.may_be_absent) return;
  if (!std::exchange(told_silence_, true) && plan_.on_silence) plan_.on_silence();
  wake_or_cut(cutting, now);
}

void PowerDown::wake_or_cut(bool cutting, TimePoint now) {
  if (std::exchange(woken_, true)) {
    if (cutting || plan_.aim != PowerAim::stop) enter(State::cut, now);
    return;
  }
  const auto sent = order(session::NodeState::pre_operational);
  result_.notes.push_back(
      is_on_ring() ? formatted("it did not answer and was sent {}", sent)
                   : formatted("it did not answer and was sent {}: a stopped node does not answer", sent));
  back_to_ = cutting ? State::cut : State::quick_stop;
  stop_since_.reset();
  state_ = State::wake;
}

/// On a ring every word is in the outputs before the request of PRE-OP ends the exchange that carries them.
void PowerDown::go_on_blindly(TimePoint now) {
  if (state_ >= State::switch_off) {
    pause_ = now + kWordPause;
    if (state_ == State::switch_off || state_ == State::switching_off) return enter(State::cut, now);
    return wake_or_cut(true, now);
  }
  if (state_ < State::quick_stop || !std::exchange(stopped_again_, true))
    return enter(State::quick_stop, now);
  pause_ = std::max(now, stop_since_.value_or(now) + kBlindStop);
  enter(State::switch_off, now);
}

/// Another signal came: what is stopped gently is stopped as fast as it can.
void PowerDown::hasten(TimePoint now) {
  if (state_ == State::look || state_ == State::halt || state_ == State::slowing ||
      state_ == State::slowing_speed)
    enter(State::quick_stop, now);
}

DriveState PowerDown::take_state(const Result<Bytes>& answer) {
  has_seen_ = answer.has_value();
  result_.statusword.reset();
  unread_.reset();
  if (answer)
    result_.statusword = static_cast<std::uint16_t>(load_le(*answer));
  else
    unread_ = answer.error();
  seen_ = result_.state();
  return seen_;
}

std::vector<session::PlannedMessage> planned_power_down(std::uint8_t node, PowerAim aim) {
  std::vector<session::PlannedMessage> out;
  const auto say = [&](std::uint16_t word, std::string when = {}) {
    out.push_back(session::planned_write({node, objects::kControlword, store_le(word, 2)}, std::move(when)));
  };
  if (aim != PowerAim::disable) say(kQuickStopWord);
  if (aim != PowerAim::stop) {
    // From any other state 00h follows the quick stop at once.
    say(kSwitchOffWord,
        aim == PowerAim::stop_and_disable ? "if it is still in operation enabled or does not answer" : "");
    say(kDisableVoltageWord);
  }
  out.push_back(session::planned_state(
      node, session::NodeState::pre_operational,
      aim == PowerAim::stop ? "if it does not answer" : "if it does not obey or answer"));
  return out;
}

namespace {

/// Process data end with the power of a drive, unless the user has it in OP. When everything ends they end.
void end_exchange(session::Session& session, const PowerDownPlan& plan, PowerDownResult& result) {
  if (plan.aim != PowerAim::stop_and_disable && session.network().stays_operational(plan.node)) {
    if (const auto back = renew_op(session, plan.node); !back)
      result.notes.push_back(back.error().message.text());
  } else if (const auto ended = session.network().end_exchange(plan.node); !ended) {
    result.notes.push_back("it could not be set back to PRE-OP: " + ended.error().message.text());
  }
}

}  // namespace

std::vector<PowerDownResult> take_down(session::Session& session, std::vector<PowerDownPlan> plans) {
  const session::Deaf deaf(session);
  std::vector<std::unique_ptr<PowerDown>> drives;
  std::vector<Dialogue*> dialogues;
  std::string nodes;
  for (auto& plan : plans) {
    append(nodes, formatted("{}", plan.node));
    plan.network = &session.network();
    drives.push_back(std::make_unique<PowerDown>(std::move(plan)));
    dialogues.push_back(drives.back().get());
  }
  session::LinkWait link(session, plans.size() > kMostNamed ? std::string("stopping all nodes")
                                  : plans.size() == 1       ? formatted("stopping node {}", nodes)
                                                            : formatted("stopping nodes {}", nodes));
  hold_all(session, dialogues, [&](const Error& lost) { return link.comes_back(lost); });
  std::vector<PowerDownResult> out;
  for (const auto& drive : drives) {
    out.push_back(drive->result());
    const bool seen = out.back().statusword && !drive::is_energised(out.back().state());
    if (out.back().written && seen && out.back().outcome) {
      session.energised().erase(drive->node());
      session.network().end_expecting(drive->node());
    }
    if (out.back().is_without_power() && !drive->plan().keeps_exchange)
      end_exchange(session, drive->plan(), out.back());
  }
  return out;
}

}  // namespace servoctl::motion
