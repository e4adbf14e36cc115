#pragma once

#include <functional>
#include <vector>

#include "commands/motion_run.hpp"
#include "commands/motion_trials.hpp"

namespace servoctl::commands {

/// Runs a motion for a test: as run_motion(), but what came of it is kept for `judge`, which makes the result
/// of it. Its errors are errors of the desk.
Result<MotionTrial> run_test_motion(
    show::Desk& desk, const MotionRequest& request,
    const std::function<Result<session::MotionPlan>(session::Motion&)>& plan,
    const std::function<session::MotionReport(session::Motion&, const session::MotionPlan&)>& run,
    const std::function<report::TestResult(const session::MotionPlan&, const session::MotionReport&)>& judge);

/// Whether the motion went to its end, and whether the drive was left without power, as criteria.
void judge_motion(const show::Desk& desk, const session::MotionReport& done, report::TestResult& out);

}  // namespace servoctl::commands
