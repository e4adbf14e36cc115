#include "session/link_wait.hpp"

#include <algorithm>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"

namespace servoctl::session {
namespace {

/// Between two lines about a bus that stays lost.
constexpr Duration kTelling = std::chrono::seconds(1);
/// A bus that is back so soon was perhaps never lost: its queue stays full, or it fails otherwise.
constexpr Duration kFlicker = std::chrono::milliseconds(10);
/// A bus that is there and fails is not asked faster than this.
constexpr Duration kPause = std::chrono::milliseconds(5);

std::string tenths(Duration time) {
  return plain_number(std::chrono::duration<double>(time).count(), 2) + " s";
}

}  // namespace

void LinkWait::tell(const std::string& line) const {
  if (session_->options().tell) session_->options().tell(line);
}

bool LinkWait::comes_back(const Error& lost) {
  const auto since = session_->now();
  const bool again = first_.has_value() && only_failing_;
  if (!first_) first_ = since;
  if (since - *first_ >= (only_failing_ ? kPatience : kMost)) return false;
  if (again)
    tell(formatted("{}: {} is still tried after {}", lost.message.text(), doing_, tenths(since - *first_)));
  else
    tell(formatted("{}: {} waits for the bus, at most {}", lost.message.text(), doing_,
                   servoctl::to_string(kPatience)));
  const auto end = since + kPatience;
  for (;;) {
    const auto asked = session_->now();
    const auto back = session_->network().recover(std::min(asked + kTelling, end));
    const auto time = session_->now();
    if (back) {
      const bool was_lost = time - since >= kFlicker;
      only_failing_ = only_failing_ && !was_lost;
      if (was_lost)
        tell(formatted("{} is back after {}: now {}", session_->url(), tenths(time - since), doing_));
      else if (!again)
        tell(formatted("{} can be opened: now {}", session_->url(), doing_));
      return true;
    }
    if (time >= end || time < asked + kPause) {
      tell(formatted("{} did not come back: {}", session_->url(), back.error().message.text()));
      return false;
    }
    tell(formatted("{} is still lost after {}: {} still waits", session_->url(), tenths(time - since),
                   doing_));
  }
}

}  // namespace servoctl::session
