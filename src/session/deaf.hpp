#pragma once

#include <utility>

#include "session/session.hpp"

namespace servoctl::session {

/// While it lives the session does not hear Ctrl-C: what was begun at a drive is put in order first. Waits
/// stay as short as they are, so the user is not kept for longer than a few timeouts.
class Deaf {
 public:
  explicit Deaf(Session& session)
      : session_(&session), before_(std::exchange(session.options().cancelled, {})) {}
  Deaf(const Deaf&) = delete;
  Deaf& operator=(const Deaf&) = delete;
  ~Deaf() { session_->options().cancelled = std::move(before_); }

 private:
  Session* session_;
  std::function<bool()> before_;
};

}  // namespace servoctl::session
