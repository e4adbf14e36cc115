#pragma once

#include "command/command.hpp"
#include "trial/motion_trials.hpp"
#include "trial/verdict.hpp"

/// What the commands `test …` have in common on the command line.
namespace servoctl::command {

inline constexpr Parameter kJunitOption{
    .name = "--junit", .help = "write the verdicts to a file as JUnit XML", .kind = Kind::file};
inline constexpr Parameter kEncoderOption{
    .name = "--encoder",
    .help = "encoder counts per motor revolution, if the drive does not report them",
    .kind = Kind::number};

/// `--for`, `--tolerance`, `--stop-within`. Errc::usage.
Result<trial::JogTrial> parse_jog_test(const Arguments& arguments, std::string_view speed);

/// `--repeat`, `--spread`. Errc::usage.
Result<trial::HomeTrial> parse_home_test(const Arguments& arguments, std::string_view method);

/// A whole number of an option from `least` to `most`; `otherwise` when it is not given. Errc::usage.
Result<std::uint32_t> count_option(const Arguments& arguments, std::string_view name, std::uint32_t least,
                                   std::uint32_t most, std::uint32_t otherwise);

/// How results are shown: `--plot`, `--junit`.
trial::VerdictOptions verdict_options(const Arguments& arguments);

}  // namespace servoctl::command
