#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drive/profile.hpp"

namespace servoctl::motion {

/// Whether a motor comes to rest when its master disappears: nothing is known that would stop it: `no`;
/// nobody says: `unknown`.
enum class Stops : std::uint8_t { no, unknown, yes };
/// `no`, `not known`, `yes`.
std::string_view text_of(Stops stops);

/// What is known of a drive that loses its master. All that is said of it, before, in and after a motion,
/// comes from here.
struct LostMaster {
  bool noticed = false;                ///< A watchdog of the drive is set.
  std::optional<std::int64_t> option;  ///< 6007h, where it has one.
  bool power_off = false;              ///< It leaves Operational (1029h), and is de-energised by that.
  bool fault = false;    ///< The family has the fault of it (8130h): without 6007h it has no power then.
  bool alarms = false;   ///< The manual names alarms of a lost communication, and no more.
  bool assumed = false;  ///< The manual does not say what the motor then does.

  Stops stops() const;
};

/// The fault 8130h of the family, life guarding or heartbeat (CiA 301, 7.2.7.1); empty: its manual names
/// none, or it is the generic one, whose list is that of the standard.
std::string lost_master_fault(const drive::Profile& profile);

/// Whether a node with this communication error behaviour (1029h:01) leaves Operational (CiA 301, 7.5.2.32).
bool leaves_operational(std::uint8_t behaviour);

}  // namespace servoctl::motion
