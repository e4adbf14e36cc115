// How a motion ends: the way down to a drive without power that is as it was.
#include <cmath>
#include <exception>
#include <utility>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "motion/kept_op.hpp"
#include "motion/motion_guard.hpp"
#include "motion/operation_mode.hpp"
#include "motion/other_axes.hpp"
#include "session/identify.hpp"
#include "session/link_wait.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {
namespace {

using drive::DriveState;

constexpr Duration kEndPause = std::chrono::milliseconds(10);
/// Longest wait for one answer while it is stopped: a drive that is lost is left to its own watchdog soon.
constexpr Duration kEndPatience = std::chrono::milliseconds(200);

bool is_lost(const Error& error) { return error.code == Errc::timeout || error.code == Errc::bus; }

}  // namespace

/// Where it is not known in which state it was, it is not taken out of another master's hands.
void MotionGuard::put_node_back() {
  if (!std::exchange(started_, false)) return;
  if (!state_before_) {
    result_.notes.emplace_back(
        session_->network().is_ring()
            ? "the slave was taken to OP and stays there: its previous state is not known"
            : "the node was started (NMT) and stays operational: its previous state is not known");
    return;
  }
  const auto sent = session_->network().request_state(node_, session::NodeState::pre_operational);
  if (!sent)
    note(formatted("the node could not be set back to {}",
                   session_->network().state_word(session::NodeState::pre_operational)),
         sent.error());
}

void MotionGuard::return_to_op() {
  if (lost_ || powered_) {
    (void)session_->network().end_exchange(node_);
    return;
  }
  if (const auto back = renew_op(*session_, node_); !back)
    result_.notes.push_back(back.error().message.text());
}

/// Of the mode that was chosen; in one that goes to a position no target stops the motor.
std::optional<session::SdoRequest> MotionGuard::zero_target() const {
  const auto& rules = units_->profile().rules.motion;
  if (!mode_ || (mode_ != rules.velocity && mode_ != rules.torque)) return std::nullopt;
  const auto target = mode_ == rules.velocity ? objects::kTargetVelocity : objects::kTargetTorque;
  return session::SdoRequest{node_, target, Bytes(od::size_of(units_->meaning(target).type).value_or(4), 0)};
}

/// Target to zero, halt where there is one, a quick stop when that does not help, then 07h and 00h.
PowerDownPlan MotionGuard::way_down() {
  PowerDownPlan plan;
  plan.node = node_;
  plan.aim = PowerAim::stop_and_disable;
  plan.keeps_exchange = held_before_;
  auto& gentle = plan.gentle.emplace();
  gentle.halt = units_->profile().rules.motion.halt;
  gentle.zero_target = zero_target();
  plan.speed = [this](ByteSpan bytes) -> std::optional<double> {
    const auto speed = units_->physical(objects::kVelocityActual, bytes);
    return speed ? std::optional(std::abs(speed->value)) : std::nullopt;
  };
  plan.standstill = standstill_.value_or(0);
  // A drive that cannot be reached is left to its own watchdog.
  plan.on_silence = [this] { disarm(); };
  return plan;
}

void MotionGuard::bring_down() {
  const session::Hurry hurry(*session_, kEndPatience, 1);
  std::vector<PowerDownPlan> plans;
  plans.push_back(way_down());
  const auto done = std::move(take_down(*session_, std::move(plans)).front());
  result_.stopped = done.stopped;
  result_.quick_stop = done.quick_stop;
  lost_ = done.silent;
  powered_ = !done.is_without_power();
  for (const auto& means : done.notes) result_.notes.push_back(means);
  if (done.ignored > 0)
    result_.left.push_back(formatted(
        "it did not obey 0000h, written {} times: its present state was not commanded", done.ignored));
  else if (!done.outcome)
    result_.left.push_back(
        (powered_ ? "it could not be de-energised: " : "its last controlword was not accepted: ") +
        done.outcome.error().message.text());
  if (lost_) disarm();
}

void MotionGuard::note(const std::string& what, const Error& error) {
  result_.left.push_back(formatted("{}: {}", what, error.message.text()));
}

/// Some drives take a refused write for a fault.
bool MotionGuard::stays_new(const Changed& changed) const {
  const auto meaning = units_->meaning(changed.object);
  const auto value = od::decode(meaning.type, changed.before);
  return meaning.type_known && value && !drive::check_limits(meaning, *value);
}

void MotionGuard::put_back() {
  for (auto changed = changed_.rbegin(); changed != changed_.rend(); ++changed) {
    // Its old targets and an old watchdog are nothing for a drive that still has its power.
    if (lost_ || powered_) {
      result_.left.push_back(
          formatted("object {} was not restored to {}", to_string(changed->object), to_hex(changed->before)));
      continue;
    }
    if (stays_new(*changed)) {
      result_.notes.push_back(
          formatted("object {} keeps its new value: its old value, {}, is out of its range",
                    to_string(changed->object), to_hex(changed->before)));
      continue;
    }
    put_back(*changed);
  }
  changed_.clear();
}

/// 6060h is 0 after power-on because no mode was chosen yet, and some drives never go back to 0: nothing is
/// lost.
void MotionGuard::keep_mode() {
  result_.notes.emplace_back(
      "no mode was chosen before (6060h was 0), and the drive does not accept 0: it keeps the mode of this "
      "motion");
}

/// What the drive acknowledges is read as well: it may not have done it, and another master may use it.
void MotionGuard::put_back(const Changed& changed) {
  session::LinkWait link(*session_,
                         formatted("restoring object {} of node {}", to_string(changed.object), node_));
  auto done = session_->download(node_, changed.object, changed.before);
  while (!done && done.error().code == Errc::bus && link.comes_back(done.error()))
    done = session_->download(node_, changed.object, changed.before);
  const auto what =
      formatted("object {} could not be restored to {}", to_string(changed.object), to_hex(changed.before));
  const bool none_chosen = changed.object == objects::kModeOfOperation && load_le(changed.before) == 0;
  if (none_chosen && !done && done.error().code == Errc::sdo_abort) return keep_mode();
  // A write whose answer is lost, or may be that to an earlier one, may have been done.
  const bool unknown = !done && done.error().code == Errc::timeout;
  const auto now_holds = done || unknown ? session_->upload(node_, changed.object) : Result<Bytes>(Bytes{});
  if (!done && !(unknown && now_holds && *now_holds == changed.before)) {
    lost_ = lost_ || is_lost(done.error());
    return note(what, done.error());
  }
  if (now_holds && *now_holds == changed.before) return;
  if (now_holds && none_chosen) return keep_mode();
  if (!now_holds && now_holds.error().code == Errc::sdo_abort)
    return;  // The drive has taken it, and tells no more.
  if (!now_holds)
    return note(formatted("object {} was written back to {}, but could not be read back",
                          to_string(changed.object), to_hex(changed.before)),
                now_holds.error());
  result_.left.push_back(formatted("{}: it was written and reads {}; does another master use the drive?",
                                   what, to_hex(*now_holds)));
}

void MotionGuard::tell_foreign_writes() {
  for (const auto& [object, way] : foreign_)
    result_.left.push_back(
        way == session::ForeignWrites::Way::rpdo
            ? formatted(
                  "another master sent a PDO with object {} meanwhile: its old value may be lost, and its "
                  "present value may be wrong",
                  to_string(object))
            : formatted(
                  "another master wrote object {} meanwhile: its old value may be lost, and its present "
                  "value may be wrong",
                  to_string(object)));
  foreign_.clear();
}

void MotionGuard::disarm() {
  if (!watchdog_) return;
  session_->network().disarm_watchdog(node_);
  watchdog_.reset();
}

/// What somebody else does with another axis of the node is part of how it is left.
void MotionGuard::tell_other_axes() {
  const session::Hurry hurry(*session_, kEndPatience, 1);
  for (const auto& axis : other_axes(*session_, &units_->profile(), node_))
    (axis.may_be_energised() ? result_.left : result_.notes).push_back(axis.text());
}

void MotionGuard::verify() {
  const auto end = session_->now() + Power::kPatience;
  for (;;) {
    const auto word = power_.statusword();
    if (!word) return note("the statusword could not be read", word.error());
    result_.statusword = *word;
    result_.state = drive::decode_state(*word);
    result_.verified = is_without_power(result_.state);
    // A fault reaction takes its time.
    if (result_.verified || session_->now() >= end || !pause(*session_, kEndPause)) break;
  }
  tell_other_axes();
  // Either of two may have told it.
  const auto single = session::refuse_duplicate(*session_, node_);
  if (single || !result_.verified) return;
  result_.verified = false;
  result_.statusword = 0;
  note("which of two drives told its state is not known", single.error());
}

MotionEnd MotionGuard::end() {
  if (end_) return *end_;
  if (rehearsal_ != nullptr) {
    rehearse_end();
    end_ = result_;
    hold_.release();
    return *end_;
  }
  const session::Deaf deaf(*session_);
  if (energised_) bring_down();
  // What is put back takes the watchdog away, and where that is cut off nobody knows.
  result_.watched = armed_ && (lost_ || powered_);
  put_back();
  put_node_back();
  if (held_before_) return_to_op();
  if (!held_before_ || lost_ || powered_) disarm();
  watchdog_.reset();
  verify();
  tell_foreign_writes();
  if (!result_.verified) session_->energised().insert(node_);
  end_ = result_;
  hold_.release();
  return *end_;
}

Result<void> MotionGuard::release() {
  if (rehearsal_ != nullptr) {
    end_ = result_;
    hold_.release();
    return {};
  }
  const session::Deaf deaf(*session_);
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
  hold_.release();
  return done;
}

}  // namespace servoctl::motion
