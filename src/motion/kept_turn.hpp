#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "motion/motion_units.hpp"
#include "session/identity.hpp"
#include "show/desk.hpp"

namespace servoctl::motion {

/// What `units learn` found of one drive: the number that no object of it tells (drive::Quotient::learned).
struct KeptTurn {
  std::uint64_t counts = 0;           ///< The number that is used,
  std::uint64_t measured = 0;         ///< and the one that was measured, give or take
  std::uint64_t uncertainty_ppm = 0;  ///< so many millionths of it.
  std::string reason;                 ///< Why that number was taken.
  std::string time;
  std::string family;
  session::Identity identity;
};

/// The file in the folder for state that holds it: one for each bus, however that was written, and node.
class TurnFile {
 public:
  /// `desk` has a session; the file's path is empty where there is no folder for state.
  TurnFile(const show::Desk& desk, std::uint8_t node);

  const std::filesystem::path& path() const { return path_; }
  /// Empty when there is none. Errc::file for one that is damaged, or was changed by somebody else.
  Result<std::optional<KeptTurn>> read() const;
  /// Errc::file.
  Result<void> write(const KeptTurn& turn) const;
  /// Whether there was one. Errc::file when it cannot be taken away.
  Result<bool> remove() const;

 private:
  std::uint8_t node_;
  std::filesystem::path path_;
};

/// What is known of a node before it moves.
struct KnownTurn {
  std::optional<double> counts;
  std::optional<KeptTurn> kept;  ///< Whether it is used or not.
  std::string unused;            ///< Why what is kept is not used; else empty.
  /// Increments of 6064h in a turn that an earlier line told (--turn) for the drive that is there now.
  std::optional<double> told_earlier;
};
/// What is kept for this node, compared with family and identity. Asks the drive only where something is
/// kept.
KnownTurn find_turn(const show::Desk& desk, std::uint8_t node);

/// What is made of parameters that take effect by a restart may be set and not in force: which of them, and
/// what to do; empty where there are none.
std::string restart_note(const drive::Profile& profile, const drive::Quotient& way);

/// Where the counts of a turn come from when they are kept ones, or parameters that may not be in force, and
/// why kept ones are not used where nothing else tells them: to be told before a motion, and with its result.
std::vector<std::string> turn_notes(const MotionUnits& units, const KnownTurn& known);

}  // namespace servoctl::motion
