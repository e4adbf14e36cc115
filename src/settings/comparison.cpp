#include "settings/comparison.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "base/pdo_index.hpp"
#include "drive/naming.hpp"
#include "show/reading.hpp"

namespace servoctl::settings {
namespace {

using report::Record;
using report::Show;
using report::Value;

struct Shown {
  std::string text = "-";
  Value record;
};

Shown show(const drive::Profile* profile, const Side& side, ObjectAddress object, bool chinese) {
  const auto found = side.values.find(object);
  if (found == side.values.end()) return {};
  const show::Reading reading{side.node, drive::target_at(profile, object), {}, found->second};
  const auto decoded = show::decode_value(reading, found->second);
  // COB-IDs, mappings and heartbeat entries are made of fields: decimal says nothing.
  const auto* parameter = reading.target.parameter;
  const auto index = parameter != nullptr && parameter->mirror ? parameter->mirror->index : object.index;
  const bool fields = index < 0x2000 && found->second.size() == 4 && decoded.unit.empty();
  auto text = fields                  ? formatted("0x{:08X}", load_le(found->second))
              : found->second.empty() ? std::string("\"\"")
                                      : decoded.text;
  const auto& shown = chinese && !decoded.label_zh.is_null() ? decoded.label_zh : decoded.label;
  if (const auto* label = std::get_if<std::string>(&shown.data())) text += " " + *label;
  return {std::move(text), Record{{"value", decoded.value},
                                  {"raw", decoded.raw},
                                  {"unit", report::text_or_null(decoded.unit)},
                                  {"label", decoded.label},
                                  {"bytes", to_hex(found->second)}}};
}

const drive::Profile* profile_of(const drive::Profile* of_both, const Side& side) {
  return side.profile != nullptr ? side.profile : of_both;
}

/// Whether one of two values that both sides have is the other as its own node's, by what describes either.
bool is_same(const drive::Profile* profile, ObjectAddress object, const Side& a, const Side& b) {
  const auto& left = a.values.at(object);
  const auto& right = b.values.at(object);
  return for_node(profile_of(profile, a), object, left, a.node, b.node) == right ||
         for_node(profile_of(profile, b), object, right, b.node, a.node) == left;
}

/// Whether a mapping entry is above the count of its PDO: it is nothing, whatever it holds.
bool is_unused(const Side& side, ObjectAddress object) {
  const auto count = side.values.find({object.index, 0});
  return is_pdo_mapping(object.index) && object.sub > 0 && count != side.values.end() &&
         load_le(count->second) < object.sub;
}

}  // namespace

std::string value_text(const drive::Profile* profile, const Side& side, ObjectAddress object, bool chinese) {
  return show(profile, side, object, chinese).text;
}

Message title_in_message(std::string_view title) {
  if (title == "factory") return "factory";
  return as_it_is(title);
}

Message title_in_message(const Side& side) {
  if (side.is_drive) return message("node {}", node_name(side.node));
  return title_in_message(std::string_view(side.title));
}

Side side_of(const Backup& backup, std::string title) {
  Side out{std::move(title), backup.identity.node, {}};
  for (const auto& entry : backup.entries)
    if (entry.bytes) out.values.emplace(entry.object, *entry.bytes);
  return out;
}

Side factory_side(const drive::Profile& profile, std::uint8_t node) {
  Side out{"factory", node, {}};
  for (const auto& setting : drive::settings_of(profile)) {
    const auto& entry = *setting.entry;
    if (!setting.left_out.empty() || !entry.default_value) continue;
    if (const auto bytes = od::encode(entry.type, entry.default_value->for_node(node)))
      out.values.emplace(entry.address, *bytes);
  }
  return out;
}

void leave_unreachable(show::Desk& desk, const drive::Profile* profile, Side& side) {
  if (desk.session == nullptr || desk.session->modbus() == nullptr || profile == nullptr) return;
  const auto left = std::erase_if(
      side.values, [&](const auto& value) { return !profile->rules.modbus.register_of(value.first); });
  if (left > 0)
    desk.notices.push_back(message("{} values of {} have no Modbus register: they are not compared", left,
                                   title_in_message(side)));
}

bool is_address(const drive::Profile* profile, ObjectAddress object) {
  if (profile == nullptr) return false;
  const auto& rules = profile->rules.nmt;
  return drive::place_of(*profile, rules.node_id) == object ||
         drive::place_of(*profile, rules.bitrate) == object;
}

bool is_target(const drive::Profile& profile, ObjectAddress object) {
  const auto& names = profile.rules.modbus.targets;
  return std::any_of(names.begin(), names.end(),
                     [&](const auto& name) { return drive::place_of(profile, name) == object; });
}

bool is_line_address(const drive::Profile& profile, ObjectAddress object) {
  const auto& rules = profile.rules.modbus;
  return drive::place_of(profile, rules.node_id) == object ||
         drive::place_of(profile, rules.baud) == object || drive::place_of(profile, rules.framing) == object;
}

Bytes for_node(const drive::Profile* profile, ObjectAddress object, const Bytes& bytes, std::uint8_t from,
               std::uint8_t to) {
  if (profile == nullptr || from == to) return bytes;
  const auto number = load_le(bytes);
  if (drive::place_of(*profile, profile->rules.nmt.node_id) == object)
    return number == from ? store_le(to, bytes.size()) : bytes;
  const auto* entry = profile->dictionary.find(object);
  const bool with_node = entry != nullptr && entry->default_value && entry->default_value->plus_node_id;
  if (!with_node || bytes.size() != 4 || (number & 0x7FU) != from) return bytes;
  return store_le(number - from + to, 4);
}

Comparison compare(const drive::Profile* profile, const Side& a, const Side& b, bool whole, bool chinese) {
  Comparison out;
  report::Table table;
  table.columns = {{"object", "", Show::text},
                   {"index", "", Show::json},
                   {"sub", "", Show::json},
                   {"id", "", Show::json},
                   {"name"},
                   {"a_text", a.title, Show::text},
                   {"a", "", Show::json},
                   {"b_text", b.title, Show::text},
                   {"b", "", Show::json}};
  std::map<ObjectAddress, int> objects;
  for (const auto* side : {&a, &b})
    for (const auto& value : side->values) ++objects[value.first];
  for (const auto& [object, sides] : objects) {
    if (sides < 2 && (!whole || is_unused(a, object) || is_unused(b, object))) continue;
    ++out.compared;
    if (sides == 2 && is_same(profile, object, a, b)) continue;
    ++out.different;
    const auto target = drive::target_at(profile_of(profile, a.values.count(object) > 0 ? a : b), object);
    auto left = show(profile_of(profile, a), a, object, chinese);
    auto right = show(profile_of(profile, b), b, object, chinese);
    table.rows.push_back({to_string(object), object.index, object.sub,
                          target.parameter != nullptr ? Value(target.parameter->id) : Value(),
                          report::text_or_null(chinese ? target.label_zh() : target.label()), left.text,
                          std::move(left.record), right.text, std::move(right.record)});
  }
  out.record = {{"compared", out.compared},
                {"different", out.different},
                {"differences", table, Show::json},
                {"table", out.different == 0 ? Value() : Value(std::move(table)), Show::text, "differences"}};
  return out;
}

Error differences_error(const Comparison& comparison, const Side& a, const Side& b) {
  return make_error(Errc::negative, message("{} of {} values differ between {} and {}", comparison.different,
                                            comparison.compared, title_in_message(a), title_in_message(b)));
}

}  // namespace servoctl::settings
