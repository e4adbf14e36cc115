#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "report/value.hpp"

/// Tests with a verdict: what was looked at, the figure that was found, the limit it is held against.
namespace servoctl::report {

enum class Verdict : std::uint8_t { passed, failed, skipped };

std::string_view name(Verdict verdict);  ///< `passed failed skipped`

/// One thing a test looks at.
struct Criterion {
  std::string id;    ///< `lost_answers`: for programs, the same in every language.
  std::string name;  ///< `lost answers`: for people.
  Verdict verdict = Verdict::passed;
  Value figure = {};          ///< A number in `unit`, or a text.
  std::string_view relation;  ///< How figure and limit belong together: `<=`, `>=`, `=`; empty: not at all.
  Value limit = {};
  std::string unit = {};
  std::string note = {};  ///< Why it was skipped, or what was seen.
};

/// Passes when `figure` is a number not above `limit`.
Criterion at_most(std::string id, std::string name, double figure, double limit, std::string unit = {});
/// Passes when `figure` is a number not below `limit`.
Criterion at_least(std::string id, std::string name, double figure, double limit, std::string unit = {});
/// Passes when `holds`; `figure` and `limit` are texts for people.
Criterion holds(std::string id, std::string name, bool holds, std::string figure, std::string limit);
/// Could not be looked at; a test is none the worse for it.
Criterion skipped(std::string id, std::string name, std::string why);

/// `12.5 ms, at most 100 ms; in 200 reads`: figure, limit and note in one line.
Message in_words(const Criterion& criterion);

/// What became of one test of one drive.
struct TestResult {
  std::string test;  ///< `comm`
  std::uint8_t node = 0;
  Record origin = {};  ///< When it was made, of which drive; empty: not known.
  double seconds = 0;  ///< How long it took.
  std::vector<Criterion> criteria;
  Record figures = {};  ///< What was measured beside the criteria.
  Plot samples = {};
};

/// Whether nothing failed, and anything was looked at.
bool passed(const TestResult& result);

/// As JUnit XML: a suite for each test of each drive, a case for each criterion. Valid whatever the texts
/// hold.
std::string junit_xml(const std::vector<TestResult>& results);

}  // namespace servoctl::report
