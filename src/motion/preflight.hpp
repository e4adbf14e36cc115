#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motion/control_source.hpp"
#include "motion/held_cautions.hpp"
#include "motion/motion_units.hpp"
#include "motion/watchdog.hpp"
#include "show/owed_restart.hpp"

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
  std::string hint = {};  ///< Of one that stops: what to do.
};
std::string_view name(PreflightItem::Weight weight);  ///< `ok note caution stop`

/// What a look before a motion is for, and what a person has told for it.
struct PreflightRequest {
  std::optional<Purpose> purpose = {};  ///< Cautions of other motions are left out; empty: none is.
  PanelValues panel = {};
  bool ignores_remote = false;             ///< Goes on although bit 9 of the statusword is 0.
  show::OwedRestart owed = {};             ///< What waits for a restart, so that the drive does not go by it.
  std::optional<OtherSource> source = {};  ///< Why the drive may not obey, by its parameters.
};

/// What there is to know before the drive is energised: state, warnings, inputs, limits, the family's
/// cautions whose condition holds. Only reads; what the drive does not have is left out.
/// Errc::timeout when it does not answer.
Result<std::vector<PreflightItem>> preflight(session::Session& session, const MotionUnits& units,
                                             std::uint8_t node, bool chinese, PreflightRequest request = {});
/// Asks about cautions that the preflight could not show. An error when the answer is no.
using AskAgain = std::function<Result<void>(const std::vector<PreflightItem>& unseen)>;
/// The whole state check once more, in OP and before the first controlword: outside OP some drives report
/// neither fault nor remote nor limits. `shown` is what the preflight has shown; a caution that is not in it
/// is asked about, and refused where nobody can be asked. Errc::refused for what lets nothing move.
Result<void> look_in_op(session::Session& session, const MotionUnits& units, std::uint8_t node, bool chinese,
                        std::span<const PreflightItem> shown, const AskAgain& ask,
                        const PreflightRequest& request = {});
/// The watchdog's line of it.
PreflightItem watchdog_item(const WatchdogPlan& watchdog);

/// Errc::refused with the first item that stops; nothing when there is none.
Result<void> check_preflight(const std::vector<PreflightItem>& items, std::uint8_t node);

}  // namespace servoctl::motion
