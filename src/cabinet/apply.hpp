#pragma once

#include <span>

#include "cabinet/cabinet_plan.hpp"

namespace servoctl::cabinet {

/// How what differs is written.
struct ApplyOptions {
  PlanChoice choice = {};
  bool keep = true;             ///< By the family's way; else the values are gone after power-off.
  bool unlock = false;          ///< Gives the password to the drives of families that have one.
  bool resume = false;          ///< Only the axes at which an apply was cut off, with what it was to write.
  bool all_or_nothing = false;  ///< One that fails puts all back, and one that cannot be looked at keeps all
                                ///< from their start.
};

/// Looks at all axes, shows what differs and asks once; then writes exactly that, to all drives at the same
/// time, each as a whole: what it holds now goes into before_file(), with the journal of a restore beside it,
/// every value is read back, and where one fails the old ones are put back. A drive that has changed since it
/// was looked at, and one that is energised, is left alone with Errc::refused.
///
/// The answer is `{cabinet, axes[{axis node bus family result written kept needs error}]}`, by --dry-run what
/// would be sent to each axis; errors and notices go to the desk. Errc::refused when nobody agreed, or, with
/// all_or_nothing, when an axis could not be looked at: nothing was written then.
Result<report::Value> apply_cabinet(show::Desk& desk, const Cabinet& cabinet,
                                    std::span<const Station> stations, const ApplyOptions& options);

}  // namespace servoctl::cabinet
