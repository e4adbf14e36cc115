#include "can/foreign_clock.hpp"

#include <algorithm>

namespace servoctl::can {
namespace {

/// Two quartzes differ by less than this part of the time.
constexpr int kDrift = 5'000;
/// A stamp that is so far off was set, or counts from another beginning.
constexpr Duration kJump = std::chrono::seconds(2);

/// So long everything has to be late before the other clock is taken for one that was set back; and by so
/// much at the least.
constexpr Duration kWindow = std::chrono::seconds(1);
constexpr Duration kSetBack = std::chrono::milliseconds(100);

}  // namespace

/// What came later than the quickest by the same time, all of it, was not under way longer.
void ForeignClock::follow(Duration late, TimePoint now) {
  if (late < least_late_) least_late_ = late;
  if (now < window_end_) return;
  if (least_late_ >= kSetBack) *offset_ += least_late_;
  least_late_ = Duration::max();
  window_end_ = now + kWindow;
}

TimePoint ForeignClock::time(Duration stamp, TimePoint now) {
  const auto passed = now - read_;
  auto unwrapped = stamp;
  if (period_ > Duration::zero() && offset_) {
    auto step = (stamp - unwrapped_) % period_;
    if (step < Duration::zero()) step += period_;
    unwrapped = unwrapped_ + step;
  }
  const auto offset = now.time_since_epoch() - unwrapped;
  // Nothing is known of periods that passed in silence.
  const bool anew = !offset_ || (period_ > Duration::zero() && passed > period_ / 2) ||
                    offset - *offset_ > kJump || *offset_ - offset > kJump;
  if (anew) {
    offset_ = offset;
    least_late_ = Duration::max();
    window_end_ = now + kWindow;
  } else {
    offset_ = std::min(offset, *offset_ + passed / kDrift);
    follow(offset - *offset_, now);
  }
  unwrapped_ = unwrapped;
  read_ = now;
  last_ = std::clamp(TimePoint(unwrapped + *offset_), std::min(last_, now), now);
  return last_;
}

}  // namespace servoctl::can
