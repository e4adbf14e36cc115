#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands/command.hpp"
#include "report/verdict.hpp"

/// Tests in which a motor moves. Each shows the pre-flight list and asks, as the motion itself does, and ends
/// as safely.
namespace servoctl::commands {

/// What came of such a test; with --dry-run the plan, and no result.
struct MotionTest {
  std::optional<report::TestResult> result;
  report::Value plan;
};

/// What `test jog` looks at.
struct JogTest {
  std::string speed;                                ///< As written: `60rpm`.
  Duration length = std::chrono::seconds(2);        ///< Of each direction; at least a second.
  double tolerance = 10;                            ///< Of the speed, in %.
  Duration longest_stop = std::chrono::seconds(1);  ///< From the command to standstill.
};

/// `--for`, `--tolerance`, `--stop-within`. Errc::usage.
Result<JogTest> parse_jog_test(const Arguments& arguments, std::string_view speed);

/// Whether it can be run as it is asked for, which only reads; so can check_home_test().
Result<void> check_jog_test(const Context& context, const Arguments& arguments, const JogTest& test);

/// Turns the motor one way and then the other.
Result<MotionTest> test_jog(Context& context, const Arguments& arguments, const JogTest& test);

inline constexpr Parameter kEncoderOption{
    .name = "--encoder",
    .help = "counts of the encoder in one turn of the motor, if the drive does not tell",
    .kind = Kind::number};

/// What `test home` looks at.
struct HomeTest {
  std::string method;  ///< Of 6098h; empty: the drive's present one.
  std::uint32_t repeat = 5;
  double spread = 1;  ///< Of the position after homing, in its unit.
};

/// `--repeat`, `--spread`. Errc::usage.
Result<HomeTest> parse_home_test(const Arguments& arguments, std::string_view method);

Result<void> check_home_test(const Context& context, const Arguments& arguments, const HomeTest& test);

/// Homes the axis several times over.
Result<MotionTest> test_home(Context& context, const Arguments& arguments, const HomeTest& test);

}  // namespace servoctl::commands
