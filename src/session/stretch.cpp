#include "session/stretch.hpp"

#include <algorithm>

#include "session/session.hpp"

namespace servoctl::session {

Stretch::Stretch(Session& session, TimePoint end, End kind)
    : session_(&session), begin_(session.now()), end_(end), kind_(kind) {
  session.stretches().push_back(this);
}

/// Jobs that run side by side end in any order.
Stretch::~Stretch() { std::erase(session_->stretches(), this); }

std::optional<double> Stretch::share(TimePoint now) const {
  if (share_) return std::clamp(*share_, 0.0, 1.0);
  if (end_ == kNever || end_ <= begin_ || kind_ == End::at_latest) return std::nullopt;
  return std::clamp(std::chrono::duration<double>(now - begin_) / (end_ - begin_), 0.0, 1.0);
}

}  // namespace servoctl::session
