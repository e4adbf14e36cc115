#pragma once

#include <string>
#include <vector>

#include "motion/motion_units.hpp"
#include "motion/watchdog.hpp"

namespace servoctl::motion {

/// One line of what is looked at before a motor may move.
struct PreflightItem {
  enum class Weight : std::uint8_t {
    good,
    note,     ///< Worth knowing.
    caution,  ///< Makes motion more dangerous than it looks.
    stop,     ///< Nothing may move.
  };
  Weight weight = Weight::note;
  std::string what;  ///< `state`, `watchdog`, `inputs`, …; empty for a caution of the family.
  std::string text;
};
std::string_view name(PreflightItem::Weight weight);  ///< `ok note caution stop`

/// What there is to know before the drive is energised: state, warnings, inputs, limits, the family's
/// cautions whose condition holds. Only reads; what the drive does not have is left out.
/// Errc::timeout when it does not answer.
Result<std::vector<PreflightItem>> preflight(session::Session& session, const MotionUnits& units,
                                             std::uint8_t node, bool chinese);
/// The watchdog's line of it.
PreflightItem watchdog_item(const WatchdogPlan& watchdog);

/// Errc::refused with the first item that stops; nothing when there is none.
Result<void> check_preflight(const std::vector<PreflightItem>& items, std::uint8_t node);

}  // namespace servoctl::motion
