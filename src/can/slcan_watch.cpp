#include "can/slcan_watch.hpp"

#include <utility>

namespace servoctl::can {
namespace {

/// Questions without an answer, and refusals of a question that was answered before.
constexpr int kMostMissed = 3;
constexpr int kMostRefused = 2;

}  // namespace

SlcanWatch::SlcanWatch(bool may_have_flags, bool has_version, TimePoint now)
    : has_flags_(may_have_flags),
      has_version_(has_version),
      heard_(now),
      due_(may_have_flags ? now
           : has_version  ? now + kQuiet
                          : kNever) {}

std::optional<TimePoint> SlcanWatch::awaited() const {
  return asked_ == 0 ? std::nullopt : std::optional(asked_at_ + kPatience);
}

std::string SlcanWatch::ask(char word, TimePoint now, Duration pause) {
  if (missed_ == 0) first_missed_ = now;
  asked_ = word;
  asked_at_ = now;
  due_ = now + pause;
  return {word, '\r'};
}

void SlcanWatch::miss() {
  if (std::exchange(asked_, 0) != 0) ++missed_;
}

std::string SlcanWatch::take_question(TimePoint now) {
  if (now < due_) return {};
  miss();
  if (missed_ >= kMostMissed) {
    if (is_silent_since(first_missed_) && (answered_ || !has_flags_)) {
      state_ = State::silent;
      due_ = kNever;
      return {};
    }
    has_flags_ = false;  // It has other things to say, or never had any.
    missed_ = 0;
  }
  if (has_flags_) return ask('F', now, kFlagsEvery);
  due_ = has_version_ ? heard_ + kQuiet : kNever;
  return has_version_ && (missed_ > 0 || now >= due_) ? ask('V', now, kFlagsEvery) : std::string();
}

bool SlcanWatch::on_flags(TimePoint now) {
  heard_ = now;
  asked_ = 0;
  missed_ = refused_ = 0;
  return std::exchange(answered_, true);
}

void SlcanWatch::on_version() {
  if (asked_ == 'V') asked_ = 0;
  if (!has_flags_) missed_ = 0;
}

bool SlcanWatch::on_answer(TimePoint now) {
  if (asked_ != 'F') return false;
  asked_ = 0;
  if (!answered_) {
    has_flags_ = false;
    due_ = has_version_ ? now + kQuiet : kNever;
  } else if (++refused_ == kMostRefused) {
    state_ = State::restarted;
  } else {
    due_ = now + kPatience;
  }
  return true;
}

}  // namespace servoctl::can
