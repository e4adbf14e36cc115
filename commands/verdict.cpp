#include "commands/verdict.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/calendar.hpp"
#include "base/file.hpp"
#include "base/number.hpp"
#include "commands/identity.hpp"
#include "report/line.hpp"

namespace servoctl::commands {
namespace {

using report::Criterion;
using report::Show;
using report::TestResult;
using report::Value;
using report::Verdict;

std::string verdict_text(const Context& context, Verdict verdict) {
  switch (verdict) {
    case Verdict::passed: return say(context, "passed", "通过");
    case Verdict::failed: return say(context, "FAILED", "未通过");
    case Verdict::skipped: break;
  }
  return say(context, "skipped", "跳过");
}

std::string limit_text(const Criterion& criterion) {
  if (criterion.relation.empty()) return {};
  const auto out = report::line_text(criterion.limit);
  if (criterion.relation == "<=") return "≤ " + out;
  return criterion.relation == ">=" ? "≥ " + out : out;
}

report::Table criteria_table(const Context& context, const TestResult& result) {
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
    table.rows.push_back({verdict_text(context, c.verdict), c.id, c.name, report::name(c.verdict),
                          c.figure.is_null() ? Value() : c.figure,
                          report::text_or_null(std::string(c.relation)), report::text_or_null(limit_text(c)),
                          c.limit, report::text_or_null(c.unit), report::text_or_null(c.note)});
  return table;
}

}  // namespace

std::string say(const Context& context, std::string_view english, std::string_view chinese) {
  return std::string(context.chinese ? chinese : english);
}

Error failure(const TestResult& result) {
  Error error;
  error.code = Errc::negative;
  error.node = result.node;
  std::string what;
  for (const auto& c : result.criteria)
    if (c.verdict == Verdict::failed)
      what += fmt::format("{}{}: {}", what.empty() ? "" : ". ", c.name, report::in_words(c));
  error.message = fmt::format("node {}: test {} failed: {}", result.node, result.test,
                              what.empty() ? "nothing could be tested" : what);
  return error;
}

report::Record verdict_record(const Context& context, const TestResult& result, Show plot) {
  report::Record out{
      {"test", result.test},
      {"node", result.node},
      {"verdict", verdict_text(context, passed(result) ? Verdict::passed : Verdict::failed), Show::text},
      {"passed", passed(result), Show::json},
      {"seconds", result.seconds, Show::json}};
  for (const auto& field : result.origin) out.push_back({field.key, field.value, Show::json});
  out.push_back({"criteria", criteria_table(context, result)});
  for (const auto& figure : result.figures) out.push_back(figure);
  if (!result.samples.series.empty()) out.push_back({"samples", result.samples, plot});
  return out;
}

report::Record origin_of(const Context& context, std::uint8_t node) {
  const auto found = session::scan(*context.session, std::span(&node, 1));
  const bool known = found && !found->empty();
  return {{"time", utc_now_text()},
          {"family", context.profile != nullptr ? Value(context.profile->family) : Value()},
          {"identity", known ? Value(identity_record(found->front())) : Value()}};
}

Value verdicts(Context& context, const Arguments& arguments, std::vector<TestResult> results) {
  const auto samples = arguments.has("--plot") ? Show::everywhere : Show::json;
  report::List out;
  for (auto& result : results) {
    result.origin = origin_of(context, result.node);
    if (!passed(result)) context.errors.push_back(failure(result));
    out.emplace_back(verdict_record(context, result, samples));
  }
  if (!arguments.has("--junit")) return Value(std::move(out));
  const auto written = write_file_atomically(arguments.text("--junit"), report::junit_xml(results));
  if (!written) context.errors.push_back(written.error());
  return Value(std::move(out));
}

Result<std::uint32_t> count_option(const Arguments& arguments, std::string_view name, std::uint32_t least,
                                   std::uint32_t most, std::uint32_t otherwise) {
  if (!arguments.has(name)) return otherwise;
  const auto number = parse_digits(arguments.text(name), 10);
  if (!number || *number < least || *number > most)
    return fail(Errc::usage,
                fmt::format("{}: '{}' is no number of {} to {}", name, arguments.text(name), least, most));
  return static_cast<std::uint32_t>(*number);
}

Result<double> number_option(const Arguments& arguments, std::string_view name, double otherwise) {
  if (!arguments.has(name)) return otherwise;
  const auto number = parse_real(arguments.text(name));
  if (!number || *number < 0)
    return fail(Errc::usage, fmt::format("{}: '{}' is no number of at least 0", name, arguments.text(name)));
  return *number;
}

double seconds_of(Duration duration) { return static_cast<double>(duration.count()) / 1e6; }
double milliseconds_of(Duration duration) { return static_cast<double>(duration.count()) / 1e3; }

}  // namespace servoctl::commands
