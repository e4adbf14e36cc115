#include "trial/figures.hpp"

#include <utility>

#include "motion/motion_monitor.hpp"
#include "trial/comm_trial.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {
namespace {

using report::find;
using report::List;
using report::Record;
using report::Show;
using report::Value;

constexpr std::string_view kRoundTrip = "round_trip_ms";
constexpr std::string_view kHomings = "homings";
constexpr std::string_view kEvents = "events";
constexpr std::string_view kHomingKeys[] = {"run", "seconds", "position", "encoder"};

Value value_or_null(const Value* value) { return value == nullptr ? Value() : *value; }

/// The unit of the positions: that of their spread, which was skipped where it is not known.
std::string unit_of(const report::TestResult& test) {
  for (const auto& series : test.samples.series)
    if (series.name == motion::name(motion::Signal::position)) return series.unit;
  for (const auto& criterion : test.criteria)
    if (criterion.id == "spread") return criterion.unit;
  return {};
}

std::vector<List> homing_rows(const Value* written) {
  std::vector<List> out;
  const auto* list = written == nullptr ? nullptr : std::get_if<List>(&written->data());
  if (list == nullptr) return out;
  for (const auto& one : *list) {
    List row;
    for (const auto key : kHomingKeys) row.push_back(value_or_null(find(one, key)));
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace

report::Field round_trip_figure(const show::Desk& desk, Value times) {
  auto* record = std::get_if<Record>(&times.data());
  if (record == nullptr) return {std::string(kRoundTrip), {}, Show::json};
  for (auto& field : *record)
    if (field.key == "p95") field.title = "95 %";
  return {std::string(kRoundTrip), std::move(times), Show::everywhere, say(desk, "round trip (ms)")};
}

report::Field homings_figure(const show::Desk& desk, std::vector<List> rows, const std::string& unit) {
  const auto of_unit = unit.empty() ? unit : " (" + unit + ")";
  report::Table table;
  for (const auto key : kHomingKeys) table.columns.push_back({std::string(key)});
  table.columns[0].title = say(desk, "attempt");
  table.columns[1].title = say(desk, "seconds");
  table.columns[2].title = say(desk, "position") + of_unit;
  table.columns[3].title = say(desk, "encoder") + of_unit;
  table.rows = std::move(rows);
  return {std::string(kHomings), std::move(table), Show::everywhere, say(desk, "homings")};
}

report::Field events_figure(Value events) { return {std::string(kEvents), std::move(events), Show::json}; }

Record figures_of(const show::Desk& desk, const report::TestResult& test, const Value& written) {
  if (test.test == kCommTestName) return {round_trip_figure(desk, value_or_null(find(written, kRoundTrip)))};
  if (test.test == "home") return {homings_figure(desk, homing_rows(find(written, kHomings)), unit_of(test))};
  if (test.test == "io") return {events_figure(value_or_null(find(written, kEvents)))};
  return {};
}

}  // namespace servoctl::trial
