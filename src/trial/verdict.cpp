#include "trial/verdict.hpp"

#include <algorithm>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "report/catalogue.hpp"
#include "report/line.hpp"
#include "show/identity.hpp"

namespace servoctl::trial {
namespace {

using report::Criterion;
using report::Show;
using report::TestResult;
using report::Value;
using report::Verdict;

std::string verdict_text(const show::Desk& desk, Verdict verdict) {
  switch (verdict) {
    case Verdict::passed: return say(desk, "passed");
    case Verdict::failed: return say(desk, "FAILED");
    case Verdict::skipped: break;
  }
  return say(desk, "skipped");
}

std::string limit_text(const Criterion& criterion) {
  if (criterion.relation.empty()) return {};
  const auto out = report::line_text(criterion.limit);
  if (criterion.relation == "<=") return "≤ " + out;
  return criterion.relation == ">=" ? "≥ " + out : out;
}

report::Table criteria_table(const show::Desk& desk, const TestResult& result) {
  report::Table table;
  table.columns = {{"verdict_text", "verdict", Show::text},
                   {"id", "", Show::json},
                   {"name", "criterion"},
                   {"verdict", "", Show::json},
                   {"figure"},
                   {"relation", "", Show::json},
                   {"limit_text", "limit", Show::text},
                   {"limit", "", Show::json},
                   {"unit"},
                   {"note"}};
  for (const auto& c : result.criteria)
    table.rows.push_back({verdict_text(desk, c.verdict), c.id, c.name, report::name(c.verdict),
                          c.figure.is_null() ? Value() : c.figure,
                          report::text_or_null(std::string(c.relation)), report::text_or_null(limit_text(c)),
                          c.limit, report::text_or_null(c.unit), report::text_or_null(c.note)});
  return table;
}

}  // namespace

std::string say(const show::Desk& desk, std::string_view english) {
  return desk.speaks_chinese() ? report::in_chinese(english) : std::string(english);
}

Error failure(const TestResult& result) {
  Message what;
  for (const auto& c : result.criteria) {
    if (c.verdict != Verdict::failed) continue;
    const auto one = message("{}: {}", c.name, report::in_words(c));
    what = what.empty() ? one : message("{}. {}", what, one);
  }
  return drive_error(
      Errc::negative, result.node,
      message("test {} failed: {}", result.test, what.empty() ? Message("nothing could be tested") : what));
}

report::Record verdict_record(const show::Desk& desk, const TestResult& result, Show plot) {
  report::Record out{
      {"test", result.test},
      {"node", result.node},
      {"verdict", verdict_text(desk, passed(result) ? Verdict::passed : Verdict::failed), Show::text},
      {"passed", passed(result), Show::json},
      {"seconds", result.seconds, Show::json}};
  for (const auto& field : result.origin) out.push_back({field.key, field.value, Show::json});
  out.push_back({"criteria", criteria_table(desk, result)});
  for (const auto& figure : result.figures) out.push_back(figure);
  out.push_back({"samples", result.samples, result.samples.series.empty() ? Show::json : plot});
  return out;
}

report::Record origin_of(const show::Desk& desk, std::uint8_t node) {
  const auto found = session::scan(*desk.session, std::span(&node, 1));
  const bool known = found && !found->empty();
  return {{"time", utc_now_text()},
          {"family", desk.profile != nullptr ? Value(desk.profile->family) : Value()},
          {"identity", known ? Value(show::identity_record(found->front())) : Value()}};
}

Value verdicts(show::Desk& desk, const VerdictOptions& options, std::vector<TestResult> results) {
  const auto samples = options.plot ? Show::everywhere : Show::json;
  report::List out;
  for (auto& result : results) {
    result.origin = origin_of(desk, result.node);
    if (!passed(result)) desk.errors.push_back(failure(result));
    out.emplace_back(verdict_record(desk, result, samples));
  }
  if (!options.junit) return Value(std::move(out));
  const auto written = write_file_atomically(*options.junit, report::junit_xml(results));
  if (!written) desk.errors.push_back(written.error());
  return Value(std::move(out));
}

double seconds_of(Duration duration) { return static_cast<double>(duration.count()) / 1e6; }
double milliseconds_of(Duration duration) { return static_cast<double>(duration.count()) / 1e3; }

}  // namespace servoctl::trial
