#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "cli/settings.hpp"
#include "cli/terminal/console.hpp"
#include "report/catalogue.hpp"
#include "report/value.hpp"

namespace servoctl::cli {

/// What became of one command line, before it is shown.
struct Outcome {
  std::string command = {};  ///< Path in the registry; empty when the line names none.
  Settings settings = {};    ///< What held for the line.
  bool uses_bus = false;
  report::Value result = {};
  std::vector<Error> errors = {};  ///< The first one makes the exit code.
  std::vector<Message> notices = {};
  bool told = false;          ///< Errors and notices are in the language of who reads already.
  bool leaves_power = false;  ///< Drives stay energised behind the line: no notice of it is hidden.
  std::string abort_words =
      {};                    ///< What the abort code of the first error means on this drive; may be empty.
  std::string axis = {};     ///< That the first error is of, as the cabinet file names it; may be empty.
  report::Names names = {};  ///< Of the family, for who reads Chinese.

  /// Exit code; 0 without errors.
  int code() const;
};

/// The first error of an outcome that has one, as it stands in JSON.
report::Value error_record(const Outcome& outcome);

/// An outcome that is nothing but an error.
Outcome failed(Error error, Settings settings, std::string_view command = {});

/// Adds what came of another bus or family of the same line: tables become one, everything else a list.
void add_outcome(Outcome& all, Outcome part);

/// Shows the outcome as its settings say, as text or as one JSON document; the answer is the exit code.
int show(Console& console, const Outcome& outcome);

/// The result as people read it, in at most `width` columns (0: as many as it takes).
std::string text_of(const Outcome& outcome, std::size_t width);

/// The notices and errors of an outcome, as they stand on stderr.
void show_remarks(Console& console, const Outcome& outcome);

}  // namespace servoctl::cli
