#pragma once

#include <algorithm>

#include "session/session.hpp"

namespace servoctl::session {

/// While it lives the session waits no longer than this for one answer.
class Hurry {
 public:
  Hurry(Session& session, Duration timeout, std::uint32_t retries)
      : session_(&session), timeout_(session.options().timeout), retries_(session.options().retries) {
    session.options().timeout = std::min(timeout_, timeout);
    session.options().retries = std::min(retries_, retries);
  }
  Hurry(const Hurry&) = delete;
  Hurry& operator=(const Hurry&) = delete;
  ~Hurry() {
    session_->options().timeout = timeout_;
    session_->options().retries = retries_;
  }

 private:
  Session* session_;
  Duration timeout_;
  std::uint32_t retries_;
};

}  // namespace servoctl::session
