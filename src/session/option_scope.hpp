#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>

#include "session/session.hpp"

namespace servoctl::session {

/// While it lives an option of the session has this value; then it has again the one before.
template <typename Value>
class OptionScope {
 public:
  OptionScope(Session& session, Value Options::*option, Value value)
      : session_(&session),
        option_(option),
        before_(std::exchange(session.options().*option, std::move(value))) {}
  OptionScope(const OptionScope&) = delete;
  OptionScope& operator=(const OptionScope&) = delete;
  ~OptionScope() { session_->options().*option_ = std::move(before_); }

 private:
  Session* session_;
  Value Options::*option_;
  Value before_;
};

/// While it lives the session does not hear Ctrl-C, and a second one does not end the process: what was begun
/// at a drive is put in order first. Waits stay as short as they are, so the user is not kept for longer than
/// a few timeouts.
class Deaf {
 public:
  explicit Deaf(Session& session)
      : cancelled_(session, &Options::cancelled, {}), hold_(session.protect(Care::unsettled)) {}

 private:
  OptionScope<std::function<bool()>> cancelled_;
  Protection::Hold hold_;
};

/// Before something is begun that Ctrl-C does not end: Errc::interrupted where the user wants an end already,
/// as a wait before it may have ended for that reason.
inline Result<void> refuse_cancelled(Session& session) {
  const auto& cancelled = session.options().cancelled;
  return cancelled && cancelled() ? Result<void>(fail(Errc::interrupted, "interrupted")) : Result<void>();
}

/// While it lives the session waits no longer than this for one answer, and asks no more often.
class Hurry {
 public:
  Hurry(Session& session, Duration timeout, std::uint32_t retries)
      : timeout_(session, &Options::timeout, std::min(session.options().timeout, timeout)),
        retries_(session, &Options::retries, std::min(session.options().retries, retries)) {}

 private:
  OptionScope<Duration> timeout_;
  OptionScope<std::uint32_t> retries_;
};

}  // namespace servoctl::session
