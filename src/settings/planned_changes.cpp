// What --dry-run shows of values that would be written.
#include "base/format.hpp"
#include "settings/change.hpp"
#include "settings/equal_values.hpp"
#include "settings/keeping_nodes.hpp"
#include "settings/stored_copies.hpp"
#include "show/planned_messages.hpp"

namespace servoctl::settings {
namespace {

using report::Value;

void add_writes(std::span<const Change> changes, session::Rehearsal& rehearsal) {
  for (const auto& change : changes)
    if (!change.unchanged)
      rehearsal.add(
          session::planned_write({change.node, change.target.address, change.data, change.transfer}));
}

void tell_unchanged(show::Desk& desk, std::span<const Change> changes) {
  for (const auto& change : changes)
    if (change.unchanged)
      desk.notices.push_back(
          message("node {}: {} is unchanged: the drive holds this value, and nothing is written",
                  node_name(change.node), change.target.in_sentence()));
}

}  // namespace

Value planned_frames(show::Desk& desk, std::span<const Change> changes) {
  session::Rehearsal rehearsal;
  add_writes(changes, rehearsal);
  if (!show::is_sent_as_frames(desk)) return show::planned_messages(desk, rehearsal.messages());
  report::Table table;
  table.columns = {{"node"}, {"object"}, {"name"}, {"when", "", report::Show::json}, {"frame"}};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (!show::would_be_sent(desk, rehearsal.messages()[i])) continue;
    table.rows.push_back(
        {changes[i].node, to_string(changes[i].target.address),
         report::text_or_null(desk.chinese ? changes[i].target.label_zh() : changes[i].target.label()),
         Value(), show::frame_text(rehearsal.messages()[i])});
  }
  return table;
}

Result<Value> planned_changes(show::Desk& desk, std::span<const Change> wanted, const WriteOptions& options) {
  auto changes = changes_with(desk, wanted, options);
  mark_unchanged(desk, changes, options);
  tell_unchanged(desk, changes);
  session::Rehearsal rehearsal;
  KeepingNodes keeping(desk, changes);
  keeping.rehearse(rehearsal);
  if (const auto opened = keeping.open(options); !opened) return fail(opened.error());
  add_writes(changes, rehearsal);
  const std::vector<Result<session::Written>> written(changes.size(), session::Written{});
  keeping.close(written);
  return show::planned_messages(desk, rehearsal.messages());
}

}  // namespace servoctl::settings
