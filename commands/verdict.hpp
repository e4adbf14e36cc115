#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "commands/command.hpp"
#include "report/verdict.hpp"

/// What the commands `test …` have in common.
namespace servoctl::commands {

inline constexpr Parameter kJunitOption{
    .name = "--junit", .help = "write the verdicts into a file as JUnit XML", .kind = Kind::file};

/// `english`, or `chinese` where names are wanted in Chinese.
std::string say(const Context& context, std::string_view english, std::string_view chinese);

/// One result as text and JSON; `plot` says where its samples are shown.
report::Record verdict_record(const Context& context, const report::TestResult& result, report::Show plot);

/// When a test that has just ended was made, of which drive: `time family identity`, what is not known null.
report::Record origin_of(const Context& context, std::uint8_t node);

/// Errc::negative with the criteria that failed.
Error failure(const report::TestResult& result);

/// The results of a command: as value, as JUnit file where `--junit` asks for one, and as exit code 1 where a
/// test failed. A file that cannot be written is one of the errors.
report::Value verdicts(Context& context, const Arguments& arguments, std::vector<report::TestResult> results);

/// A whole number of an option from `least` to `most`; `otherwise` when it is not given. Errc::usage.
Result<std::uint32_t> count_option(const Arguments& arguments, std::string_view name, std::uint32_t least,
                                   std::uint32_t most, std::uint32_t otherwise);

/// A number of at least 0; `otherwise` when it is not given. Errc::usage.
Result<double> number_option(const Arguments& arguments, std::string_view name, double otherwise);

/// Seconds as a number.
double seconds_of(Duration duration);
/// Milliseconds as a number, to the microsecond.
double milliseconds_of(Duration duration);

}  // namespace servoctl::commands
