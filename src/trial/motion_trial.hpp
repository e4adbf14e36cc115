#pragma once

#include <functional>
#include <vector>

#include "motion/motion_run.hpp"
#include "trial/motion_trials.hpp"

namespace servoctl::trial {

/// Runs a motion for a test: as run_motion(), but what came of it is kept for `judge`, which makes the result
/// of it. Its errors are errors of the desk.
Result<MotionTrial> run_test_motion(
    show::Desk& desk, const motion::MotionRequest& request,
    const std::function<Result<motion::MotionPlan>(motion::Motion&)>& plan,
    const std::function<motion::MotionReport(motion::Motion&, const motion::MotionPlan&)>& run,
    const std::function<report::TestResult(const motion::MotionPlan&, const motion::MotionReport&)>& judge);

/// Whether the motion went to its end, and whether the drive was left without power, as criteria.
void judge_motion(const show::Desk& desk, const motion::MotionReport& done, report::TestResult& out);

}  // namespace servoctl::trial
