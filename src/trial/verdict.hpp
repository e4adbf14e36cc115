#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/verdict.hpp"
#include "show/desk.hpp"

/// What the commands `test …` have in common.
namespace servoctl::trial {

/// What the catalogue has for it, where the desk speaks Chinese.
std::string say(const show::Desk& desk, std::string_view english);

/// One result as text and JSON; `plot` says where its samples are shown.
report::Record verdict_record(const show::Desk& desk, const report::TestResult& result, report::Show plot);

/// When a test that has just ended was made, of which drive: `time family identity`, what is not known null.
report::Record origin_of(const show::Desk& desk, std::uint8_t node);

/// Errc::negative with the criteria that failed.
Error failure(const report::TestResult& result);

/// How results are shown.
struct VerdictOptions {
  bool plot = false;                           ///< Samples are drawn for people.
  std::optional<std::filesystem::path> junit;  ///< Written as JUnit XML as well.
};

/// The results of a command: as value, as JUnit file where one is asked for, and as exit code 1 where a test
/// failed. A file that cannot be written is one of the errors.
report::Value verdicts(show::Desk& desk, const VerdictOptions& options,
                       std::vector<report::TestResult> results);

/// Seconds as a number.
double seconds_of(Duration duration);
/// Milliseconds as a number, to the microsecond.
double milliseconds_of(Duration duration);

}  // namespace servoctl::trial
