#pragma once

#include <filesystem>
#include <vector>

#include "report/verdict.hpp"
#include "show/desk.hpp"

namespace servoctl::trial {

/// The results in a file that `test … --json` wrote: one document, or several, one a line. Errc::file when it
/// holds something else.
Result<std::vector<report::TestResult>> read_tests(const std::filesystem::path& file);

/// Holds tests of nodes of the desk against the drives that are there now. Errc::refused where one was
/// made of another drive or family; a notice where it does not tell. A node that does not answer is left out.
/// Errc::bus or interrupted.
Result<void> check_tested(show::Desk& desk, const std::vector<report::TestResult>& tests);

}  // namespace servoctl::trial
