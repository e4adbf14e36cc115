#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "drive/power_path.hpp"
#include "drive/profile.hpp"
#include "drive/standard_objects.hpp"
#include "motion/control_source.hpp"
#include "motion/power_down.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// Bits of the statusword that are no part of the state (CiA 402-2, 8.4.2).
inline constexpr std::uint16_t kVoltageEnabled = 1U << 4U;
inline constexpr std::uint16_t kWarning = 1U << 7U;
inline constexpr std::uint16_t kRemote = 1U << 9U;
inline constexpr std::uint16_t kTargetReached = 1U << 10U;
inline constexpr std::uint16_t kInternalLimit = 1U << 11U;

/// Why bit 9 may be 0, besides a node that is not operational.
inline constexpr std::string_view kRemoteCauses =
    "its panel, its own software or an input controls it, or a parameter selects another source of commands";

/// The power state of one drive, read and changed by SDO.
class Power {
 public:
  /// Longest wait for one transition.
  static constexpr Duration kPatience = PowerDown::kPatience;

  Power(session::Session& session, const drive::Profile& profile, std::uint8_t node)
      : session_(&session), profile_(&profile), node_(node) {}

  /// What reach() names where the drive does not follow: nothing is read then, as stop words come first.
  void set_other_source(std::optional<OtherSource> source) { source_ = std::move(source); }
  Result<std::uint16_t> statusword();
  Result<drive::DriveState> state();
  /// Writes the controlword (6040h) as it is; nothing is waited for.
  Result<void> command(std::uint16_t controlword);
  /// Goes to the state by the shortest legal way and waits in every state on it until the statusword shows
  /// it. Errc::refused where there is no way: out of a fault (`fault reset` is asked for separately);
  /// Errc::negative when the drive does not follow, with what its statusword says of the reason.
  Result<void> reach(drive::DriveState goal);
  /// The steps that reach() makes from there when the drive follows; Errc::refused as there.
  Result<std::vector<drive::PowerStep>> path_to(drive::DriveState from, drive::DriveState goal);
  /// Takes the power away (PowerAim::disable). Errc::negative when it was not seen to go, or when 0000h could
  /// not be written. Neither this nor quick_stop() hears Ctrl-C, and both wait for a bus that is lost
  /// (LinkWait).
  Result<void> disable();
  /// Stops a drive that is energised as fast as it can, and waits until it has no power or stands still in
  /// "quick stop active", where 605Ah lets it stay. Errc::negative when it does not follow, or when
  /// that it stands still is not seen within PowerDown::kQuickStopPatience.
  Result<void> quick_stop();
  /// Waits until the drive is in this state; false when it is not after kPatience.
  Result<bool> wait_for(drive::DriveState state);

  /// Whether the family sets this bit of the statusword whenever it is ready, so that a low one says
  /// something.
  bool tells(std::uint16_t bit) const;
  /// `nmt start -n 1`, where the node is not known to be operational: some drives obey 6040h in that state
  /// only.
  std::string start_command() const;

 private:
  Result<void> take_down(PowerAim aim);
  bool says_go();
  Result<void> step(drive::DriveState from, const drive::PowerStep& next);
  Error stuck(drive::DriveState from, const drive::PowerStep& next) const;
  Result<bool> resumes();

  session::Session* session_;
  const drive::Profile* profile_;
  std::uint8_t node_;
  std::uint16_t statusword_ = 0;  ///< Read last.
  std::optional<OtherSource> source_;
};

/// The end of stopping and disabling one drive.
struct DeEnergised {
  std::uint8_t node = 0;
  Result<void> outcome;
  /// De-energised, but in fault: whether it obeyed the stop is not known.
  bool in_fault = false;
};

/// Stops and disables these drives, all at the same time. Does not hear Ctrl-C.
std::vector<DeEnergised> de_energise(session::Session& session, const std::set<std::uint8_t>& nodes);
/// The same for every drive that was left energised through this session.
std::vector<DeEnergised> de_energise(session::Session& session);

/// The drive is energised although servoctl has not done it.
Error enabled_by_others(std::uint8_t node, drive::DriveState state);

/// Waits without doing anything; heartbeats go on and events are heard.
Result<void> pause(session::Session& session, Duration time);

}  // namespace servoctl::motion
