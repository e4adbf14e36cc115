#pragma once

#include <optional>
#include <vector>

#include "base/time.hpp"
#include "show/pdo_book.hpp"

namespace servoctl::traffic {

/// PDOs of the process data that a ring exchanges with one slave: those of 1C12h and 1C13h.
class ImagePdos {
 public:
  /// What one cycle carried of a PDO.
  struct Cycle {
    Bytes data;
    TimePoint time;  ///< When its frame was sent.
  };

  /// The PDOs that are assigned, by the drive's word. Errc::negative when no process data flow with the node:
  /// the drive is asked for nothing then.
  static Result<std::vector<show::PdoView>> read(show::Desk& desk, std::uint8_t node);

  explicit ImagePdos(session::Session& session) : session_(&session) {}
  /// The cycle of this PDO that came since `since`, if any. The drive takes RPDOs in OP only.
  std::optional<Cycle> take(const show::PdoView& view, TimePoint since) const;

 private:
  session::Session* session_;
};

}  // namespace servoctl::traffic
