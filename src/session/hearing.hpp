#pragma once

#include <utility>

#include "session/session.hpp"

namespace servoctl::session {

/// While it lives `on_frame` is told every frame the session receives, in every wait: transfers as well.
class Hearing {
 public:
  using OnFrame = std::function<void(const can::Frame& frame, TimePoint time)>;

  Hearing(Session& session, OnFrame on_frame)
      : session_(&session), before_(std::exchange(session.options().heard, std::move(on_frame))) {}
  Hearing(const Hearing&) = delete;
  Hearing& operator=(const Hearing&) = delete;
  ~Hearing() { session_->options().heard = std::move(before_); }

 private:
  Session* session_;
  OnFrame before_;
};

}  // namespace servoctl::session
