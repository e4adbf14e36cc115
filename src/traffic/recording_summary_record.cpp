// A RecordingSummary as tables.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/format.hpp"
#include "drive/cia402.hpp"
#include "show/fault_records.hpp"
#include "show/records.hpp"
#include "traffic/recording_summary.hpp"
#include "traffic/rhythm_table.hpp"

namespace servoctl::traffic {
namespace {

using report::Value;

Value rounded_ms(double number) { return Value(std::round(number * 1000) / 1000); }

std::vector<report::Table::Column> object_columns() {
  return {{"node"},
          {"object", "", report::Show::text},
          {"index", "", report::Show::json},
          {"sub", "", report::Show::json},
          {"name"}};
}

void add_object(report::List& row, const drive::Target& target, bool chinese) {
  row.insert(row.end(),
             {Value(to_string(target.address)), Value(target.address.index), Value(target.address.sub),
              report::text_or_null(chinese ? target.label_zh() : target.label())});
}

}  // namespace

/// Since the first frame.
double RecordingSummary::seconds(Duration time) const {
  return std::chrono::duration<double>(time - begin_).count();
}

/// Of the nodes that -n names; without it all.
bool RecordingSummary::is_wanted(std::uint8_t node) const {
  const auto& nodes = desk_->nodes;
  return nodes.empty() ||
         std::any_of(nodes.begin(), nodes.end(), [node](auto each) { return each == 0 || each == node; });
}

report::Table RecordingSummary::nodes_table() const {
  report::Table out;
  out.columns = {{"node"},
                 {"family"},
                 {"frames"},
                 {"nmt", "NMT state"},
                 {"state"},
                 {"boot_ups", "boot-ups"},
                 {"heartbeat_ms", "heartbeat (ms)"},
                 {"heartbeat_max_ms", "longest (ms)"},
                 {"answer_max_ms", "slowest answer (ms)"},
                 {"aborts", "SDO aborts"},
                 {"unanswered"}};
  for (const auto& [id, node] : nodes_) {
    if (!is_wanted(id)) continue;
    const auto* family = family_of(id);
    const auto& beats = node.heartbeats.intervals();
    const auto state = node.statusword ? std::optional(drive::decode_state(*node.statusword)) : std::nullopt;
    out.rows.push_back(
        {id, family != nullptr ? Value(family->family) : Value(), node.frames,
         report::text_or_null(std::string(node.nmt)), state ? Value(drive::name(*state)) : Value(),
         node.boot_ups, beats.count() > 0 ? rounded_ms(beats.mean()) : Value(),
         beats.count() > 0 ? rounded_ms(beats.greatest()) : Value(),
         node.slowest_ms > 0 ? rounded_ms(node.slowest_ms) : Value(), node.aborts, node.unanswered});
  }
  return out;
}

report::Table RecordingSummary::periods_table() const {
  report::Table out;
  out.columns = {{"can_id", "CAN-ID"}, {"what"}, {"node"}};
  for (auto& column : rhythm_columns()) out.columns.push_back(std::move(column));
  for (const auto& [can_id, cycle] : cycles_) {
    if (cycle.node && !is_wanted(*cycle.node)) continue;
    report::List row{Value(formatted("0x{:03X}", can_id & 0x1FFF'FFFFU)), cycle.name,
                     cycle.node ? Value(*cycle.node) : Value()};
    for (auto& cell : rhythm_cells(cycle.rhythm)) row.push_back(std::move(cell));
    out.rows.push_back(std::move(row));
  }
  return out;
}

report::Table RecordingSummary::emergencies_table() const {
  report::Table out;
  out.columns = {{"node"}, {"code"}, {"text"}, {"count"}, {"first_s", "first (s)"}, {"last_s", "last (s)"}};
  for (const auto& [key, times] : emergencies_)
    if (is_wanted(key.first))
      out.rows.push_back({key.first, Value(formatted("0x{:04X}", key.second)),
                          show::fault_words(family_of(key.first), desk_->speaks_chinese(), key.second),
                          times.count, seconds(times.first), seconds(times.last)});
  return out;
}

report::Table RecordingSummary::aborts_table() const {
  report::Table out;
  out.columns = object_columns();
  for (auto* key : {"abort", "text", "count"}) out.columns.push_back({key});
  out.columns.push_back({"first_s", "first (s)"});
  for (const auto& [key, times] : aborts_) {
    const auto& [id, object, code] = key;
    if (!is_wanted(id)) continue;
    report::List row{id};
    add_object(row, drive::target_at(family_of(id), object), desk_->chinese);
    row.insert(row.end(), {Value(formatted("0x{:08X}", code)),
                           Value(show::abort_words(family_of(id), desk_->speaks_chinese(), code)),
                           Value(times.count), Value(seconds(times.first))});
    out.rows.push_back(std::move(row));
  }
  return out;
}

report::Table RecordingSummary::unanswered_table() const {
  report::Table out;
  out.columns = object_columns();
  out.columns.push_back({"count"});
  out.columns.push_back({"first_s", "first (s)"});
  for (const auto& [key, times] : unanswered_) {
    if (!is_wanted(key.first)) continue;
    report::List row{key.first};
    add_object(row, drive::target_at(family_of(key.first), key.second), desk_->chinese);
    row.insert(row.end(), {Value(times.count), Value(seconds(times.first))});
    out.rows.push_back(std::move(row));
  }
  return out;
}

report::Record RecordingSummary::record(std::string_view begin) const {
  report::Table services;
  services.columns = {{"service"}, {"frames"}};
  for (const auto& [service, count] : services_) services.rows.push_back({service, count});
  using report::Show;
  // Frames without times have none between them.
  const bool timed = last_ != begin_;
  const auto if_timed = timed ? Show::everywhere : Show::json;
  report::Record out{
      {"frames", frames_},
      {"begin", report::text_or_null(std::string(begin)), begin.empty() ? Show::json : Show::everywhere,
       "first frame"},
      {"seconds", timed ? Value(seconds(last_)) : Value(), if_timed},
      {"gap_ms", timed ? rounded_ms(std::chrono::duration<double, std::milli>(gap_).count()) : Value(),
       if_timed, "longest gap (ms)"},
      {"gap_at_s", timed ? Value(seconds(gap_at_)) : Value(), if_timed, "which begins at (s)"},
      {"services", std::move(services)}};
  const auto add = [&](std::string key, report::Table table, std::string title = {}) {
    const auto show = table.rows.empty() ? Show::json : Show::everywhere;
    out.push_back({std::move(key), std::move(table), show, std::move(title)});
  };
  add("nodes", nodes_table());
  add("periods", periods_table());
  add("emergencies", emergencies_table());
  add("aborts", aborts_table(), "SDO aborts");
  add("unanswered", unanswered_table(), "SDO requests without an answer");
  return out;
}

}  // namespace servoctl::traffic
