#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motion/motion_run.hpp"
#include "report/verdict.hpp"

/// Tests in which a motor moves. Each shows the pre-flight list and asks, as the motion itself does, and ends
/// as safely.
namespace servoctl::trial {

/// What came of such a test; with --dry-run the plan, and no result.
struct MotionTrial {
  std::optional<report::TestResult> result;
  report::Value plan;
};

/// What `test jog` looks at.
struct JogTrial {
  std::string speed;                                ///< As written: `60rpm`.
  Duration length = std::chrono::seconds(2);        ///< Of each direction; at least a second.
  double tolerance = 10;                            ///< Of the speed, in %.
  Duration longest_stop = std::chrono::seconds(1);  ///< From the command to standstill.
  std::string then = {};  ///< What comes behind it, for the question; empty: nothing.
};

/// Whether it can be run as it is asked for, which only reads; so can check_home_test().
Result<void> check_jog_test(const show::Desk& desk, const motion::MotionRequest& request,
                            const JogTrial& test);

/// Turns the motor one way and then the other.
Result<MotionTrial> test_jog(show::Desk& desk, const motion::MotionRequest& request, const JogTrial& test);

/// What `test home` looks at.
struct HomeTrial {
  std::string method;  ///< Of 6098h; empty: the drive's present one.
  std::uint32_t repeat = 5;
  double spread = 1;  ///< Of the position after homing, in its unit.
};

/// The answer is what would be done: method, speeds, how often, how long and how far; empty where that could
/// not be asked.
Result<std::string> check_home_test(const show::Desk& desk, const motion::MotionRequest& request,
                                    const HomeTrial& test);

/// Homes the axis several times over.
Result<MotionTrial> test_home(show::Desk& desk, const motion::MotionRequest& request, const HomeTrial& test);

}  // namespace servoctl::trial
