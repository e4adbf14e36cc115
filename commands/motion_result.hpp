#pragma once

#include "session/motion_kinds.hpp"
#include "show/desk.hpp"

namespace servoctl::commands {

/// The answer of a motion: what was asked, how it went, how the drive was left, the numbers on the way, and
/// all samples: in JSON where the desk keeps them, in text as a plot where one is wanted. What went wrong
/// goes to `desk.errors`, what the node told to the notices.
report::Value motion_result(show::Desk& desk, std::uint8_t node, const session::MotionPlan& plan,
                            const std::vector<session::PreflightItem>& items,
                            const session::MotionReport& done, bool plot);

/// How a motion left the drive: `switch on disabled, verified`, or loudly that it could not be verified.
std::string end_text(const session::MotionEnd& end, const session::WatchdogPlan& watchdog);

/// The pre-flight list as a table.
report::Table preflight_table(const std::vector<session::PreflightItem>& items);
/// The same as lines for a notice or a question, `caution  watchdog  none: …`.
std::string preflight_text(const std::vector<session::PreflightItem>& items);

/// One sample as `-o jsonl` shows it, and as a line.
report::Record sample_record(const session::MotionSample& sample, TimePoint begin);
std::string sample_line(const session::MotionSample& sample, TimePoint begin,
                        const session::MotionUnits& units);

/// Writes the series as a table, one line a sample: `seconds,position (deg),…`. Errc::file.
Result<void> write_csv(const std::string& path, const std::vector<session::MotionSample>& samples,
                       const session::MotionUnits& units);

}  // namespace servoctl::commands
