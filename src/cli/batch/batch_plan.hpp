#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "cli/batch/batch.hpp"
#include "cli/batch/expression.hpp"
#include "cli/batch/variables.hpp"

namespace servoctl::cli {

/// One thing a batch file does, with its variables filled in.
struct Step {
  enum class Kind : std::uint8_t { command, expect, pause, wait };
  Kind kind = Kind::command;
  std::uint32_t line = 0;  ///< Of the file.
  std::string text;        ///< The line as it is run.
  bool goes_on = false;    ///< `on-error continue` holds: a failure does not end the run.
  std::string round = {};  ///< Of the loops around it: `AXIS=axes.csv:7`, `A=1 B=x`; empty outside of loops.
  std::vector<std::string> words = {};  ///< Of a command; the text of a pause.
  Expression expression = {};
  Duration duration{};
};

/// All a batch file does: nothing in it depends on an answer of a drive, so loops are unrolled beforehand.
struct Plan {
  std::vector<Step> steps;
  std::vector<Error> errors;  ///< Each with its line; what a loop repeats is told once.
};

/// More errors than these help nobody.
inline constexpr std::size_t kMostErrors = 100;

/// Errors of lines, each reported once however often a loop meets it.
class LineErrors {
 public:
  /// Adds the error with its line and, behind its message, the round of the loop it was met in.
  void add(std::uint32_t line, const std::string& round, Error error);
  std::size_t size() const { return errors_.size(); }
  std::vector<Error> take() { return std::move(errors_); }

 private:
  std::set<std::pair<std::uint32_t, std::string>> told_;
  std::vector<Error> errors_;
};

/// The error with the round behind its message; unchanged outside of loops.
Error in_round(const std::string& round, Error error);

/// Files that loops read are looked for in `folder`.
Plan plan_batch(const Batch& batch, Variables variables, const std::filesystem::path& folder);

}  // namespace servoctl::cli
