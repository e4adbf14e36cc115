#pragma once

#include "motion/motion_kinds.hpp"
#include "show/desk.hpp"

namespace servoctl::motion {

/// The answer of a motion: what was asked, how it went, how the drive was left, the numbers on the way, and
/// all samples: in JSON where the desk keeps them, in text as a plot where one is wanted. What went wrong
/// goes to `desk.errors`, what the node told to the notices.
report::Value motion_result(show::Desk& desk, std::uint8_t node, const MotionPlan& plan,
                            const std::vector<PreflightItem>& items, const MotionReport& done, bool plot);

/// How a motion left the drive: `switch on disabled, verified`, or loudly that it could not be verified.
std::string end_text(const MotionEnd& end, const WatchdogPlan& watchdog);

/// The pre-flight list as a table.
report::Table preflight_table(const std::vector<PreflightItem>& items);
/// The same as lines for a notice or a question, `caution  watchdog  none: …`.
std::string preflight_text(const std::vector<PreflightItem>& items, bool chinese);

/// How much an item weighs, in the width that it has before every item.
std::string weight_column(PreflightItem::Weight weight, bool chinese);

/// One sample as `-o jsonl` shows it, and as a line.
report::Record sample_record(const MotionSample& sample, TimePoint begin);
std::string sample_line(const MotionSample& sample, TimePoint begin, const MotionUnits& units);

/// Writes the series as a table, one line a sample: `seconds,position (deg),…`. Errc::file.
Result<void> write_csv(const std::string& path, const std::vector<MotionSample>& samples,
                       const MotionUnits& units);

}  // namespace servoctl::motion
