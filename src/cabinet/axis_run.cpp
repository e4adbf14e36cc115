#include "cabinet/axis_run.hpp"

#include <fmt/format.h>

#include "session/storage.hpp"
#include "show/records.hpp"

namespace servoctl::cabinet {
namespace {

using report::List;
using report::Value;
using settings::RestoreEnd;

/// Null where no manual tells.
Value kept(const AxisRun& run, bool keep) {
  if (!run.is_written()) return {};
  if (run.end == AxisEnd::not_kept || !keep) return false;
  return unstated(run).empty() ? Value(true) : Value();
}

/// What is to be done for the values to hold: a restart.
const AxisNeed* restart_of(const AxisRun& run) {
  if (!run.is_written()) return nullptr;
  for (const auto& need : run.look->plan->needs)
    if (need.kind == AxisNeed::Kind::restart) return &need;
  return nullptr;
}

List row(const AxisRun& run, bool keep) {
  const auto& axis = *run.look->axis;
  const auto* restart = restart_of(run);
  List names;
  if (restart != nullptr)
    for (const auto& name : restart->names) names.emplace_back(name);
  const auto error = !run.look->plan      ? show::error_record(run.look->plan.error())
                     : run.errors.empty() ? Value()
                                          : show::error_record(run.errors.front());
  return {axis.name,        axis.bus,
          axis.node,        axis.family,
          text_of(run.end), run.is_written() ? run.look->plan->to_write : 0U,
          kept(run, keep),  restart != nullptr ? Value(to_string(*restart)) : Value(),
          std::move(names), error};
}

}  // namespace

std::string_view text_of(AxisEnd end) {
  switch (end) {
    case AxisEnd::untouched: return "not changed";
    case AxisEnd::nothing_to_do: return "nothing to do";
    case AxisEnd::planned: return "to be written";
    case AxisEnd::applied: return "applied";
    case AxisEnd::not_kept: return "applied, but not kept; see the error";
    case AxisEnd::as_before: return "put back: every value is as it was before";
    case AxisEnd::flash_changed: return "put back, but its flash may not be as it was; see the errors";
    case AxisEnd::undone: return "put back, because another axis failed";
    case AxisEnd::failed: return "failed; see the errors";
  }
  return {};
}

AxisEnd end_of(RestoreEnd end) {
  switch (end) {
    case RestoreEnd::idle: return AxisEnd::nothing_to_do;
    case RestoreEnd::planned: return AxisEnd::planned;
    case RestoreEnd::done: return AxisEnd::applied;
    case RestoreEnd::not_kept: return AxisEnd::not_kept;
    case RestoreEnd::rolled_back: return AxisEnd::as_before;
    case RestoreEnd::flash_changed: return AxisEnd::flash_changed;
    case RestoreEnd::astray:
    case RestoreEnd::left: break;
  }
  return AxisEnd::failed;
}

bool AxisRun::has_failed() const {
  return end == AxisEnd::untouched || end == AxisEnd::not_kept || end == AxisEnd::as_before ||
         end == AxisEnd::flash_changed || end == AxisEnd::failed;
}

void AxisRun::end_without_write() {
  errors = look->plan->left;
  if (errors.empty()) end = AxisEnd::nothing_to_do;
}

void AxisRun::end_undo(const Result<settings::Restored>& done) {
  const bool is_back = done && (done->end == RestoreEnd::done || done->end == RestoreEnd::idle);
  end = !is_back ? AxisEnd::failed : in_flash.empty() ? AxisEnd::undone : AxisEnd::flash_changed;
  if (!done) errors.push_back(done.error());
  if (!in_flash.empty()) errors.push_back(settings::flash_error(station.profile, look->axis->node, in_flash));
}

std::vector<std::string> unstated(const AxisRun& run) {
  std::vector<std::string> out;
  const auto& plan = *run.look->plan;
  for (const auto& entry : plan.wanted.entries) {
    const auto present = plan.present.find(entry.object);
    const bool written = present != plan.present.end() && present->second != entry.bytes;
    if (written && !session::is_known_to_keep(*run.station.profile, entry.object))
      out.push_back(to_string(entry.object));
  }
  return out;
}

Value apply_table(const std::vector<AxisRun>& runs, bool keep) {
  report::Table table;
  table.columns = {{"axis"},
                   {"bus", "", report::Show::json},
                   {"node"},
                   {"family"},
                   {"result"},
                   {"values"},
                   {"kept"},
                   {"needs"},
                   {"restart", "", report::Show::json},
                   {"error", "", report::Show::json}};
  for (const auto& run : runs) table.rows.push_back(row(run, keep));
  return Value(std::move(table));
}

}  // namespace servoctl::cabinet
