#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "session/session.hpp"

namespace servoctl::session {

/// Patience of who only listens or reads with a bus that is lost: an interface that went down, a controller
/// that went bus-off and an adapter that was unplugged come back more often than not.
class BusReturn {
 public:
  /// Longest wait of what is read to the end, as a backup.
  static constexpr Duration kPatience = std::chrono::seconds(10);
  /// Told a line when the bus is lost, and one when it is back.
  using Tell = std::function<void(bool back, std::string_view line)>;

  /// `nodes` are asked who they are when the bus is back, where the session knew it before.
  explicit BusReturn(Session& session, Tell tell, std::span<const std::uint8_t> nodes = {})
      : session_(&session), tell_(std::move(tell)), nodes_(nodes.begin(), nodes.end()) {}

  /// Tells Options::tell.
  static Tell to_people(Session& session);

  /// After Errc::bus: waits until the bus is back, `end` at most (kNever: until somebody interrupts).
  /// What was heard is not taken for going on meanwhile: the line after this one opens the bus anew
  /// (Session::was_away). Errors: `lost` itself, where it is not back, somebody interrupts, it never comes
  /// back, or is lost again at once; and where servoctl sends something regularly or has left a drive
  /// energised, which ends with the bus. Errc::refused where one of the nodes is another drive now; one that
  /// does not answer yet is heard when it starts.
  Result<void> wait(const Error& lost, TimePoint end);

 private:
  bool sends_regularly() const;
  Result<void> reopen(TimePoint end);
  std::vector<Identity> known() const;
  Result<void> hold(std::span<const Identity> before);

  Session* session_;
  Tell tell_;
  std::vector<std::uint8_t> nodes_;
  TimePoint flickered_ = TimePoint::min();  ///< When it was back at once, as one that was never away.
};

}  // namespace servoctl::session
