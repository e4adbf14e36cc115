#pragma once

#include <filesystem>
#include <vector>

#include "base/result.hpp"
#include "report/verdict.hpp"

namespace servoctl::commands {

/// The results in a file that `test … --json` wrote: one document, or several, one a line. Errc::file when it
/// holds something else.
Result<std::vector<report::TestResult>> read_tests(const std::filesystem::path& file);

}  // namespace servoctl::commands
