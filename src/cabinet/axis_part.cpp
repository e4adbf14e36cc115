#include "cabinet/axis_part.hpp"

#include <algorithm>
#include <cmath>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/node_list.hpp"
#include "drive/naming.hpp"
#include "drive/parameter_ids.hpp"
#include "drive/pdo_recipe_reader.hpp"

namespace servoctl::cabinet {
namespace {

using drive::get;
using drive::get_int;
using drive::into;
using drive::TableReader;

constexpr Duration kLongestHeartbeat = std::chrono::milliseconds(65535);  // 1017h is an u16.

Place place_of(const toml::node& node) { return {node.source().begin.line, node.source().begin.column}; }

/// `1`, or `"1-40"`.
bool read_nodes(const toml::node& node, std::vector<std::uint8_t>& out) {
  std::string text;
  std::int64_t number = 0;
  if (get_int(node, number)) text = std::to_string(number);
  if (text.empty() && !get(node, text)) return false;
  auto nodes = canopen::parse_node_ids(text, {});
  if (nodes) out = std::move(*nodes);
  return nodes.has_value();
}

/// `"feeders"`, or a list.
bool read_groups(const toml::node& node, std::vector<std::string>& out) {
  std::string one;
  if (!get(node, one)) return get(node, out);
  out = {one};
  return true;
}

bool read_serial(const toml::node& node, std::optional<std::uint32_t>& out) {
  if (get(node, out)) return true;
  std::string text;
  const auto number = get(node, text) ? parse_integer(text) : std::nullopt;
  if (!number || number->negative || number->magnitude > 0xFFFF'FFFF) return false;
  out = static_cast<std::uint32_t>(number->magnitude);
  return true;
}

bool read_counts(const toml::node& node, std::optional<std::uint64_t>& out) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40U;
  return get(node, out) && *out > 0 && *out <= kMost;
}

/// `10`, `2.5`, or `"10:1"`: revolutions of the motor to those of the output.
bool read_gear(const toml::node& node, std::optional<double>& out) {
  std::string text;
  if (const auto number = node.value<double>()) out = *number;
  if (node.is_string() && get(node, text)) {
    const auto parts = split(std::string_view(text), ':');
    const auto motor = parts.size() == 2 ? parse_real(trim(parts[0])) : std::nullopt;
    const auto output = parts.size() == 2 ? parse_real(trim(parts[1])) : std::nullopt;
    if (!motor || !output || *output <= 0) return false;
    out = *motor / *output;
  }
  return out && std::isfinite(*out) && *out > 0;
}

bool read_heartbeat(const toml::node& node, AxisPart& out) {
  std::string text;
  if (!get(node, text)) return false;
  const auto time = equals_nocase(text, "off") ? std::optional(Duration::zero()) : parse_duration(text);
  if (!time || *time > kLongestHeartbeat || *time % std::chrono::milliseconds(1) != Duration::zero())
    return false;
  out.heartbeat = *time;
  out.heartbeat_at = place_of(node);
  return true;
}

bool read_limits(const toml::node& node, Limits& out, std::string_view file, std::optional<Error>& inner) {
  const auto* table = node.as_table();
  if (table == nullptr) return false;
  const auto done = TableReader(*table, file)
                        .read({{"speed", into(out.speed)},
                               {"torque", into(out.torque)},
                               {"window", into(out.window)},
                               {"following_error", into(out.following_error)}});
  if (!done) inner = done.error();
  out.at = place_of(node);
  return done.has_value();
}

/// The name of a preset, a file, or a list of tables.
bool read_pdos(const toml::node& node, Pdos& out, std::string_view file, std::optional<Error>& inner) {
  out.at = place_of(node);
  if (const auto* list = node.as_array()) {
    const auto read = drive::read_recipes(*list, file, out.recipes);
    if (!read) inner = read.error();
    return read && !out.recipes.empty();
  }
  std::string text;
  if (!get(node, text) || text.empty()) return false;
  if (text.find('.') == std::string::npos)
    out.preset = text;
  else
    out.file = text;
  return true;
}

/// Numbers, labels and numbers with units, as they are typed.
std::optional<std::string> value_text(const toml::node& node) {
  std::string text;
  std::int64_t whole = 0;
  if (get(node, text)) return text;
  if (get_int(node, whole)) return std::to_string(whole);
  if (const auto number = node.value_exact<double>(); number && std::isfinite(*number))
    return formatted("{}", *number);
  return std::nullopt;
}

Result<void> read_parameters(const toml::node& node, std::string_view file, std::vector<Setting>& out) {
  const auto* table = node.as_table();
  if (table == nullptr) {
    const auto at = node.source().begin;
    return fail(file_error(file, at.line, at.column, "'parameters' is a table: Pn0202 = 2"));
  }
  const TableReader reader(*table, file);
  for (const auto& [key, value] : *table) {
    auto text = value_text(value);
    if (!text)
      return reader.fail_at(value,
                            message("the value of '{}' is no number and no text", as_it_is(key.str())));
    const Place at{key.source().begin.line, key.source().begin.column};
    const auto id = drive::canonical_id(key.str());
    const auto same = [&id](const Setting& other) { return drive::canonical_id(other.name) == id; };
    if (const auto twice = std::find_if(out.begin(), out.end(), same); twice != out.end())
      return reader.fail_at(
          value, message("'{}' and '{}' are the same", as_it_is(twice->name), as_it_is(key.str())));
    out.push_back({std::string(key.str()), std::move(*text), at});
  }
  std::stable_sort(out.begin(), out.end(), [](const Setting& a, const Setting& b) {
    return std::pair(a.at.line, a.at.column) < std::pair(b.at.line, b.at.column);
  });
  return {};
}

const TableReader::Forms& forms() {
  static const TableReader::Forms all{
      {"node", "node = 3 (1..127), or \"1-40\" for axes named feeder{1-40}"},
      {"group", "group = \"feeders\", or a list"},
      {"serial", "serial = \"0x12345678\""},
      {"turn", "turn = 131072: increments of 6064h per motor revolution"},
      {"encoder", "encoder = 131072: counts of the encoder per motor revolution"},
      {"gear", "gear = \"10:1\" (motor to output), or 10"},
      {"per_turn", "per_turn = \"20 mm\""},
      {"limits", "limits = { speed = \"500rpm\", torque = \"80%\" }"},
      {"heartbeat", "heartbeat = \"100ms\" (at most 65535ms), or \"off\""},
      {"pdos", "pdos = \"pp\" (a preset), \"FILE.toml\", or a list of tables as in such a file"}};
  return all;
}

void take(std::string& to, const std::string& from) {
  if (to.empty()) to = from;
}

template <class T>
void take(std::optional<T>& to, const std::optional<T>& from) {
  if (!to) to = from;
}

}  // namespace

Result<AxisPart> read_part(const toml::table& table, std::string_view file, PartOf kind) {
  AxisPart out;
  std::optional<Error> inner;
  TableReader::Handlers handlers{
      {"turn", [&](const auto& n) { return read_counts(n, out.turn); }},
      {"encoder", [&](const auto& n) { return read_counts(n, out.encoder); }},
      {"gear", [&](const auto& n) { return read_gear(n, out.gear); }},
      {"per_turn",
       [&](const auto& n) {
         out.per_turn_at = place_of(n);
         return get(n, out.per_turn);
       }},
      {"limits", [&](const auto& n) { return read_limits(n, out.limits, file, inner); }},
      {"heartbeat", [&](const auto& n) { return read_heartbeat(n, out); }},
      {"pdos", [&](const auto& n) { return read_pdos(n, out.pdos, file, inner); }},
      {"parameters", [&](const auto& n) {
         const auto done = read_parameters(n, file, out.parameters);
         if (!done) inner = done.error();
         return done.has_value();
       }}};
  if (kind != PartOf::family) {
    handlers.emplace("bus", into(out.bus));
    handlers.emplace("family", into(out.family));
  }
  if (kind == PartOf::axis) {
    handlers.emplace("node", [&](const auto& n) { return read_nodes(n, out.nodes); });
    handlers.emplace("group", [&](const auto& n) { return read_groups(n, out.groups); });
    handlers.emplace("serial", [&](const auto& n) { return read_serial(n, out.serial); });
  }
  const auto done = TableReader(table, file).read(handlers, forms());
  if (inner) return fail(std::move(*inner));
  if (!done) return fail(done.error());
  return out;
}

void fill_from(AxisPart& part, const AxisPart& defaults) {
  take(part.bus, defaults.bus);
  take(part.family, defaults.family);
  take(part.turn, defaults.turn);
  take(part.encoder, defaults.encoder);
  take(part.gear, defaults.gear);
  if (!part.per_turn) part.per_turn_at = defaults.per_turn_at;
  take(part.per_turn, defaults.per_turn);
  if (part.limits.at.line == 0) part.limits.at = defaults.limits.at;
  take(part.limits.speed, defaults.limits.speed);
  take(part.limits.torque, defaults.limits.torque);
  take(part.limits.window, defaults.limits.window);
  take(part.limits.following_error, defaults.limits.following_error);
  if (!part.heartbeat) part.heartbeat_at = defaults.heartbeat_at;
  take(part.heartbeat, defaults.heartbeat);
  if (!part.pdos.said()) part.pdos = defaults.pdos;
  for (const auto& setting : defaults.parameters) {
    const auto id = drive::canonical_id(setting.name);
    if (std::none_of(part.parameters.begin(), part.parameters.end(),
                     [&](const Setting& own) { return drive::canonical_id(own.name) == id; }))
      part.parameters.push_back(setting);
  }
}

}  // namespace servoctl::cabinet
