#include "settings/address_table.hpp"

#include <utility>

#include "drive/bitrate.hpp"
#include "show/records.hpp"

namespace servoctl::settings {
namespace {

using report::Show;
using report::Value;

Value kept_value(session::Kept kept) {
  return kept == session::Kept::unknown ? Value() : Value(kept == session::Kept::yes);
}

report::List address_row(const AddressChange& change, const AddressOutcome& outcome) {
  report::List stayed;
  for (const auto object : outcome.stayed) stayed.emplace_back(to_string(object));
  return {change.node,
          change.to,
          change.bitrate ? Value(*change.bitrate) : Value(),
          change.bitrate ? Value(drive::bitrate_text(*change.bitrate)) : Value(),
          change.identity.serial ? Value(*change.identity.serial) : Value(),
          text_of(outcome.end),
          kept_value(outcome.kept),
          Value(std::move(stayed)),
          outcome.error ? show::error_record(*outcome.error) : Value()};
}

}  // namespace

report::Table address_table(std::span<const AddressChange> changes,
                            std::span<const AddressOutcome> outcomes) {
  report::Table table;
  table.columns = {{"node"},
                   {"new_node", "new"},
                   {"bitrate", "", Show::json},
                   {"bitrate_text", "bitrate", Show::text},
                   {"serial"},
                   {"result"},
                   {"kept", "", Show::json},
                   {"cob_ids_left", "", Show::json},
                   {"error", "", Show::json}};
  for (std::size_t i = 0; i < changes.size(); ++i) table.rows.push_back(address_row(changes[i], outcomes[i]));
  return table;
}

report::Table address_steps(std::span<const AddressRow> rows, const AddressJournal& journal) {
  report::Table table;
  table.columns = {{"step"}, {"node"}, {"new_node", "new"}, {"remark"}};
  for (std::size_t i = journal.done; i < journal.steps.size(); ++i) {
    const auto& step = journal.steps[i];
    const bool aside = step.to != rows[step.row].to;
    table.rows.push_back({i + 1, step.from, step.to, aside ? Value("steps aside for a while") : Value()});
  }
  return table;
}

}  // namespace servoctl::settings
