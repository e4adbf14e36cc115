#include "show/identity.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <optional>
#include <utility>

#include "drive/cia402.hpp"
#include "show/fault_records.hpp"
#include "show/field_reader.hpp"

namespace servoctl::show {
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

/// A line of 80 columns has room for what tells the drive apart: its profile fits beside that.
std::span<const session::Guess> without_generic(std::span<const session::Guess> guesses) {
  const auto first = std::find_if(guesses.begin(), guesses.end(), [](const auto& g) { return g.generic; });
  const auto own = static_cast<std::size_t>(first - guesses.begin());
  return own == 0 ? guesses : guesses.first(own);
}

Value number_or_null(const std::optional<std::uint32_t>& number) { return number ? Value(*number) : Value(); }

std::optional<std::uint32_t> narrow(std::optional<std::uint64_t> number) {
  return number ? std::optional(static_cast<std::uint32_t>(*number)) : std::nullopt;
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

void add_condition_columns(bool in_full, report::Table& table) {
  if (!in_full)
    for (const auto* title : {"state", "fault"}) table.columns.push_back({title, "", report::Show::text});
  for (const auto* key : {"state", "statusword", "fault"})
    table.columns.push_back({key, "", report::Show::json});
}

void add_condition(const Desk& desk, const Condition& condition, bool in_full, report::List& row) {
  Value name;
  Value shown;
  if (condition.statusword) {
    const auto state = drive::decode_state(*condition.statusword);
    name = drive::name(state);
    shown = desk.chinese ? Value(drive::name_zh(state)) : name;
  }
  const auto fault = told_fault(desk.profile, desk.chinese, condition.fault, condition.statusword);
  if (!in_full) {
    row.push_back(std::move(shown));
    row.push_back(fault.cell(0));
  }
  row.push_back(std::move(name));
  row.push_back(condition.statusword ? Value(*condition.statusword) : Value());
  row.push_back(fault.record());
}

report::Table identity_table(const Desk& desk, std::span<const session::Identity> nodes,
                             std::span<const Condition> conditions, std::span<const drive::Family> families,
                             bool in_full) {
  using report::Show;
  const auto full = in_full ? Show::everywhere : Show::json;
  report::Table table;
  table.columns = {{"node"},
                   {"device_type", "device type", full},
                   {"vendor_id", "vendor", full},
                   {"product_code", "product", full},
                   {"revision", "", full},
                   {"serial", "", full},
                   {"device_name", "name"},
                   {"hardware_version", "hardware", Show::json},
                   {"software_version", "software", full},
                   {"nmt", "", Show::json},
                   {"guess", "family", Show::text},
                   {"families", "", Show::json}};
  if (!in_full) table.columns.push_back({"NMT", "", Show::text});
  add_condition_columns(in_full, table);
  table.json_only = nodes.empty();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto& node = nodes[i];
    const auto guesses = session::guess_families(node, families);
    const auto nmt = node.state ? Value(session::name(*node.state)) : Value();
    table.rows.push_back(
        {node.node, hex(node.device_type), hex(node.vendor_id), hex(node.product_code), hex(node.revision),
         hex(node.serial), report::text_or_null(node.device_name),
         report::text_or_null(node.hardware_version), report::text_or_null(node.software_version), nmt,
         report::text_or_null(guess_text(without_generic(guesses))), guess_records(guesses)});
    if (!in_full) table.rows.back().push_back(nmt);
    add_condition(desk, conditions[i], in_full, table.rows.back());
  }
  return table;
}

report::Record identity_record(const session::Identity& i) {
  return {{"device_type", number_or_null(i.device_type)},
          {"vendor_id", number_or_null(i.vendor_id)},
          {"product_code", number_or_null(i.product_code)},
          {"revision", number_or_null(i.revision)},
          {"serial", number_or_null(i.serial)},
          {"device_name", report::text_or_null(i.device_name)},
          {"hardware_version", report::text_or_null(i.hardware_version)},
          {"software_version", report::text_or_null(i.software_version)}};
}

std::optional<session::Identity> identity_of(const Value& record, std::uint8_t node) {
  session::Identity out;
  out.node = node;
  FieldReader fields(record, "identity");
  out.device_type = narrow(fields.number("device_type"));
  out.vendor_id = narrow(fields.number("vendor_id"));
  out.product_code = narrow(fields.number("product_code"));
  out.revision = narrow(fields.number("revision"));
  out.serial = narrow(fields.number("serial"));
  out.device_name = fields.text("device_name");
  out.hardware_version = fields.text("hardware_version");
  out.software_version = fields.text("software_version");
  return fields.error() ? std::nullopt : std::optional(std::move(out));
}

std::string other_kind(const session::Identity& one, const session::Identity& other) {
  const auto differ = [](const auto& a, const auto& b) { return a && b && *a != *b; };
  if (differ(one.device_type, other.device_type)) return "its device type (1000h)";
  if (differ(one.vendor_id, other.vendor_id)) return "its vendor (1018h:01)";
  if (differ(one.product_code, other.product_code)) return "its product code (1018h:02)";
  return {};
}

session::Identity lasting(const session::Identity& identity) {
  session::Identity out;
  out.node = identity.node;
  out.device_type = identity.device_type;
  out.vendor_id = identity.vendor_id;
  out.product_code = identity.product_code;
  out.revision = identity.revision;
  out.serial = identity.serial;
  out.device_name = identity.device_name;
  return out;
}

std::string change_of(const session::Identity& before, const session::Identity& now) {
  if (auto number = session::different_number(before, now); !number.empty()) return number;
  // A file holds no bytes that are no text.
  const auto as_kept = [](const session::Identity& one) { return report::to_json(Value(one.device_name)); };
  return as_kept(before) != as_kept(now) ? "its name (1008h)" : std::string();
}

session::BeforeDetails warn_of_details(const Desk& desk, std::span<const drive::Family> families) {
  if (desk.profile != nullptr && !desk.profile->is_generic()) return {};  // The user named it.
  return [&desk, families](std::span<const session::Identity> found) {
    const auto& tell = desk.session->options().tell;
    const auto line = session::warning_of_details(found, families);
    if (tell && !line.empty()) tell(line);
  };
}

}  // namespace servoctl::show
