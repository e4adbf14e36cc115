#include "report/verdict.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "report/line.hpp"

namespace servoctl::report {
namespace {

Criterion compared(std::string id, std::string name, bool fits, double figure, std::string_view relation,
                   double limit, std::string unit) {
  return {.id = std::move(id),
          .name = std::move(name),
          .verdict = fits ? Verdict::passed : Verdict::failed,
          .figure = figure,
          .relation = relation,
          .limit = limit,
          .unit = std::move(unit)};
}

}  // namespace

std::string_view name(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed: return "passed";
    case Verdict::failed: return "failed";
    case Verdict::skipped: break;
  }
  return "skipped";
}

Criterion at_most(std::string id, std::string name, double figure, double limit, std::string unit) {
  return compared(std::move(id), std::move(name), figure <= limit, figure, "<=", limit, std::move(unit));
}

Criterion at_least(std::string id, std::string name, double figure, double limit, std::string unit) {
  return compared(std::move(id), std::move(name), figure >= limit, figure, ">=", limit, std::move(unit));
}

Criterion holds(std::string id, std::string name, bool holds, std::string figure, std::string limit) {
  return {.id = std::move(id),
          .name = std::move(name),
          .verdict = holds ? Verdict::passed : Verdict::failed,
          .figure = std::move(figure),
          .relation = "=",
          .limit = std::move(limit)};
}

Criterion skipped(std::string id, std::string name, std::string why) {
  return {.id = std::move(id),
          .name = std::move(name),
          .verdict = Verdict::skipped,
          .relation = {},
          .note = std::move(why)};
}

Message in_words(const Criterion& criterion) {
  const auto unit = criterion.unit.empty() ? std::string() : " " + criterion.unit;
  const auto figure = criterion.figure.is_null() ? std::string() : line_text(criterion.figure) + unit;
  const auto limit = line_text(criterion.limit) + unit;
  Message out = figure;
  if (criterion.relation == "<=") out = message("{}, at most {}", figure, limit);
  if (criterion.relation == ">=") out = message("{}, at least {}", figure, limit);
  if (criterion.relation == "=") out = message("{}, wanted: {}", figure, limit);
  if (criterion.note.empty()) return out;
  return out.empty() ? Message(criterion.note) : message("{}; {}", out, criterion.note);
}

bool passed(const TestResult& result) {
  const auto count = [&](Verdict verdict) {
    return std::count_if(result.criteria.begin(), result.criteria.end(),
                         [&](const Criterion& c) { return c.verdict == verdict; });
  };
  return count(Verdict::failed) == 0 && count(Verdict::passed) > 0;
}

}  // namespace servoctl::report
