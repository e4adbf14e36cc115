#include "commands/identity.hpp"

#include <optional>

namespace servoctl::commands {
namespace {

using report::Value;

/// Without leading zeros: four of them and the names have to fit a line of 80 columns.
Value hex(std::optional<std::uint32_t> number) { return number ? Value(report::Hex{*number, 1}) : Value(); }

Value guess_records(std::span<const session::Guess> guesses) {
  report::List out;
  for (const auto& guess : guesses)
    out.emplace_back(report::Record{{"family", guess.family}, {"certain", guess.certain}});
  return out;
}

}  // namespace

std::string guess_text(std::span<const session::Guess> guesses) {
  std::string out;
  for (const auto& guess : guesses) {
    if (!out.empty()) out += " or ";
    out += guess.family + (guess.certain ? "" : "?");
  }
  return out;
}

report::Table identity_table(std::span<const session::Identity> nodes,
                             std::span<const drive::Family> families) {
  using report::Show;
  report::Table table;
  table.columns = {{"node"},
                   {"device_type", "device type"},
                   {"vendor_id", "vendor"},
                   {"product_code", "product"},
                   {"revision"},
                   {"serial"},
                   {"device_name", "name"},
                   {"hardware_version", "hardware", Show::json},
                   {"software_version", "software"},
                   {"nmt", "", Show::json},
                   {"guess", "family", Show::text},
                   {"families", "", Show::json}};
  table.json_only = nodes.empty();
  for (const auto& node : nodes) {
    const auto guesses = session::guess_families(node, families);
    table.rows.push_back({node.node, hex(node.device_type), hex(node.vendor_id), hex(node.product_code),
                          hex(node.revision), hex(node.serial), report::text_or_null(node.device_name),
                          report::text_or_null(node.hardware_version),
                          report::text_or_null(node.software_version),
                          node.nmt ? Value(canopen::name(*node.nmt)) : Value(),
                          report::text_or_null(guess_text(guesses)), guess_records(guesses)});
  }
  return table;
}

}  // namespace servoctl::commands
