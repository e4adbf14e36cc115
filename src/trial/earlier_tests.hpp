#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/verdict.hpp"
#include "show/desk.hpp"

namespace servoctl::trial {

/// A result, and where it was made: the node is in it.
struct EarlierTest {
  report::TestResult result;
  std::string axis;  ///< Its name in the cabinet file; empty where the line named none.
  std::string bus;   ///< URL; of axes on several buses all of theirs, with commas between them.
};

/// The results in a file that `test … --json` wrote: one document, or several, one a line. Errc::file when it
/// holds something else.
Result<std::vector<EarlierTest>> read_tests(const show::Desk& desk, const std::filesystem::path& file);

/// The drive that a report is of. `bus` is empty where all of them are on one: whatever that was called when
/// a test was made, it is the same.
struct TestedDrive {
  std::uint8_t node = 0;
  std::string_view axis;
  std::string_view bus;
};

/// Whether a test was made there: by the name of the axis where both have one, else by the node.
bool is_of(const EarlierTest& test, const TestedDrive& drive);

/// Holds tests of nodes of the desk against the drives that are there now. Errc::refused where one was
/// made of another drive or family; a notice where it does not tell. A node that does not answer is left out.
/// Errc::bus or interrupted.
Result<void> check_tested(show::Desk& desk, const std::vector<report::TestResult>& tests);

}  // namespace servoctl::trial
