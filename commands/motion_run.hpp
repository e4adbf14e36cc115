#pragma once

#include <functional>
#include <vector>

#include "commands/motion_options.hpp"
#include "commands/motion_tests.hpp"

namespace servoctl::commands {

/// Runs a motion for a test: as run_motion(), but what came of it is kept for `judge`, which makes the result
/// of it. Its errors are errors of the context.
Result<MotionTest> run_test_motion(
    Context& context, const Arguments& arguments,
    const std::function<Result<session::MotionPlan>(session::Motion&)>& plan,
    const std::function<session::MotionReport(session::Motion&, const session::MotionPlan&)>& run,
    const std::function<report::TestResult(const session::MotionPlan&, const session::MotionReport&)>& judge);

/// Whether the motion went to its end, and whether the drive was left without power, as criteria.
void judge_motion(const Context& context, const session::MotionReport& done, report::TestResult& out);

}  // namespace servoctl::commands
