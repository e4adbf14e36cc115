#pragma once

#include <optional>
#include <string>

#include "session/session.hpp"

namespace servoctl::session {

/// Patience of a way out with a bus that is lost: a drive that nothing stops may turn on behind it, and an
/// interface that went down, or a controller that went bus-off, comes back more often than not.
class LinkWait {
 public:
  /// Longest wait for a bus that is lost.
  static constexpr Duration kPatience = std::chrono::seconds(10);
  /// … for one that is lost again and again, in all.
  static constexpr Duration kMost = std::chrono::seconds(60);

  /// `doing` is what is tried again: `stopping node 1`.
  LinkWait(Session& session, std::string doing) : session_(&session), doing_(std::move(doing)) {}

  /// After Errc::bus: waits until the bus is back; false when it is not in time. What goes on is told a line
  /// at a time (Options::tell).
  bool comes_back(const Error& lost);

 private:
  void tell(const std::string& line) const;

  Session* session_;
  std::string doing_;
  std::optional<TimePoint> first_;  ///< When the bus was lost for the first time.
  bool only_failing_ = true;        ///< It could be opened at once, each time.
};

}  // namespace servoctl::session
