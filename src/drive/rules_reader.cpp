#include "drive/rules_reader.hpp"

#include <algorithm>
#include <map>

#include "base/number.hpp"
#include "drive/pdo_recipe_reader.hpp"

namespace servoctl::drive {
namespace {

using Handlers = TableReader::Handlers;

bool get(const toml::node& node, Condition& out) {
  return has_only(node, {"object", "value"}) && drive::get(at(node, "object"), out.object) &&
         get_int(at(node, "value"), out.value);
}

/// `{ object, value }` or `{ object, text }`, with `mask` and `soft` where needed.
bool get(const toml::node& node, IdentityMark& out) {
  const auto* table = node.as_table();
  if (table == nullptr || table->get("object") == nullptr ||
      (table->get("value") == nullptr) == (table->get("text") == nullptr))
    return false;
  return TableReader(*table, "")
      .read({{"object", into(out.object)},
             {"value", [&](const auto& n) { return get_int(n, out.value); }},
             {"mask", [&](const auto& n) { return get_int(n, out.mask); }},
             {"text", [&](const auto& n) { return drive::get(n, out.text) && !out.text.empty(); }},
             {"soft", into(out.soft)}})
      .has_value();
}

bool get(const toml::node& node, Setting& out) {
  return has_only(node, {"name", "value"}) && drive::get(at(node, "name"), out.name) &&
         get_int(at(node, "value"), out.value);
}

bool get(const toml::node& node, PowerParameter& out) {
  return has_only(node, {"name", "end", "value"}) && drive::get(at(node, "name"), out.name) &&
         drive::get(at(node, "end"), out.end) && get_int(at(node, "value"), out.value);
}

bool get(const toml::node& node, ModeBits& out) {
  return has_only(node, {"mode", "disabled"}) && get_int(at(node, "mode"), out.mode) &&
         get_int(at(node, "disabled"), out.disabled);
}

/// `[start, size]`.
bool get(const toml::node& node, EscArea& out) {
  std::vector<std::uint16_t> numbers;
  if (!drive::get(node, numbers) || numbers.size() != 2 || numbers[0] + numbers[1] > 0x10000) return false;
  out = {numbers[0], numbers[1]};
  return true;
}

/// `[least, greatest]`, neither of them 0.
bool get_range(const toml::node& node, std::vector<std::uint16_t>& out) {
  return drive::get(node, out) && out.size() == 2 && out[0] != 0 && out[0] <= out[1];
}

bool get(const toml::node& node, PdoRules::When& out) {
  std::string text;
  if (!drive::get(node, text)) return false;
  if (text == "always") out = PdoRules::When::always;
  if (text == "invalid") out = PdoRules::When::invalid;
  if (text == "not operational") out = PdoRules::When::not_operational;
  return text == "always" || text == "invalid" || text == "not operational";
}

bool get(const toml::node& node, NmtRules::Restart& out) {
  std::string text;
  if (!drive::get(node, text)) return false;
  if (text == "power cycle") out = NmtRules::Restart::power_cycle;
  if (text == "reset node") out = NmtRules::Restart::reset_node;
  if (text == "reset communication") out = NmtRules::Restart::reset_communication;
  return text == "power cycle" || text == "reset node" || text == "reset communication";
}

template <class T>
TableReader::Handler list_into(std::vector<T>& out, std::string_view form) {
  return {[&out](const toml::node& node) {
            return get_list(node, out, [](const toml::node& n, T& o) { return get(n, o); });
          },
          form};
}

constexpr std::string_view kMarks =
    R"([{ object = "0x1018:01", value = 0x1234 }], or text = "NAME"; mask and soft are optional)";
constexpr std::string_view kSettings = R"([{ name = "P1-01", value = 1 }])";
constexpr std::string_view kConditionForm = R"({ object = "0x2001:00", value = 1 })";
constexpr std::string_view kWhenForm = R"("always", "invalid" or "not operational")";

/// A table whose keys are numbers, `{ 3 = 12 }`.
template <class T>
bool read_numbered(const toml::node& node, std::map<std::int64_t, T>& out) {
  const auto* table = node.as_table();
  if (table == nullptr) return false;
  for (const auto& [key, value] : *table) {
    const auto number = parse_signed(std::string_view(key.str()));
    if (!number || !drive::get(value, out[*number])) return false;
  }
  return true;
}

TableReader::Handler condition_into(std::optional<Condition>& out) {
  return {[&out](const toml::node& node) { return get(node, out.emplace()); }, kConditionForm};
}

}  // namespace

Result<void> read_identity(const TableReader& reader, Rules& rules) {
  return reader.read({{"certain", into(rules.identity_certain)},
                      {"telling", into(rules.identity_telling)},
                      {"match", list_into(rules.identity, kMarks)},
                      {"looks", into(rules.identity_looks)}});
}

Result<void> read_numbering(const TableReader& reader, Numbering& out) {
  return reader.read(
      {{"prefix", into(out.prefix)},
       {"index", into(out.index)},
       {"base", [&](const auto& n) { return get_int(n, out.base) && (out.base == 10 || out.base == 16); }},
       {"group", into(out.group)},
       {"block", [&](const auto& n) { return get_int(n, out.block) && out.block > 0; }},
       {"first_sub", into(out.first_sub)},
       {"unlisted", into(out.unlisted)},
       {"read_only", into(out.read_only)}});
}

Result<void> read_sdo(const TableReader& reader, Rules& rules) {
  return reader.read({{"segmented", into(rules.sdo.segmented)},
                      {"block", into(rules.sdo.block)},
                      {"exact_length", into(rules.sdo.exact_length)},
                      {"echoes_data", into(rules.sdo.echoes_data)},
                      {"short_writes", into(rules.sdo.short_writes)}});
}

Result<void> read_nmt(const TableReader& reader, Rules& rules) {
  auto& out = rules.nmt;
  return reader.read({{"node_id", into(out.node_id)},
                      {"bitrate", into(out.bitrate)},
                      {"address_after",
                       {[&](const toml::node& node) { return get(node, out.address_after); },
                        R"("power cycle", "reset node" or "reset communication")"}},
                      {"autostart", into(out.autostart)},
                      {"guarding_alarm", into(out.guarding_alarm)},
                      {"max_nodes", into(out.max_nodes)},
                      {"needs", list_into(out.needs, kSettings)},
                      {"lost_alarms", into(out.lost_alarms)},
                      {"disables_outside_operational", into(out.disables_outside_operational)}});
}

Result<void> read_pdo(const TableReader& reader, Rules& rules) {
  auto& out = rules.pdo;
  const auto types = [&](const toml::node& node) {
    const auto* table = node.as_table();
    if (table == nullptr) return false;
    for (const auto& [key, value] : *table) {
      const auto type = parse_digits(std::string_view(key.str()), 10);
      std::string text;
      if (!type || *type > 255 || !drive::get(value, text)) return false;
      out.types[static_cast<std::int64_t>(*type)] = std::move(text);
    }
    return true;
  };
  const auto presets = [&](const toml::node& node) {
    return get_list(node, out.presets, [](const toml::node& n, PdoPreset& o) { return drive::get(n, o); });
  };
  return reader.read({{"cob_id_bits", into(out.cob_id_bits)},
                      {"parameters", {[&](const auto& n) { return get(n, out.parameters); }, kWhenForm}},
                      {"mapping", {[&](const auto& n) { return get(n, out.mapping); }, kWhenForm}},
                      {"inhibit_while_valid", into(out.inhibit_while_valid)},
                      {"disable_by_count", into(out.disable_by_count)},
                      {"clears_entries", into(out.clears_entries)},
                      {"most_entries", into(out.most_entries)},
                      {"most_bits", into(out.most_bits)},
                      {"whole_bytes", into(out.whole_bytes)},
                      {"mapped_abort", into(out.mapped_abort)},
                      {"refused_types", into(out.refused_types)},
                      {"types", types},
                      {"preset", presets},
                      {"assign_rpdo", into(out.assign_rpdo)},
                      {"assign_tpdo", into(out.assign_tpdo)}});
}

Result<void> read_coe(const TableReader& reader, Rules& rules) {
  auto& out = rules.coe;
  return reader.read({{"mailbox_out", [&](const auto& n) { return get(n, out.mailbox_out); }},
                      {"mailbox_in", [&](const auto& n) { return get(n, out.mailbox_in); }},
                      {"outputs", into(out.outputs)},
                      {"inputs", into(out.inputs)},
                      {"rpdo", into(out.rpdo)},
                      {"tpdo", into(out.tpdo)},
                      {"sdo_info", into(out.sdo_info)},
                      {"complete_access", into(out.complete_access)}});
}

Result<void> read_store(const TableReader& reader, Rules& rules) {
  auto& out = rules.store;
  return reader.read({{"store", list_into(out.store, kSettings)},
                      {"restore", list_into(out.restore, kSettings)},
                      {"objects", into(out.objects)},
                      {"flash_switch", into(out.flash_switch)},
                      {"to_ram", into(out.to_ram)},
                      {"to_flash", into(out.to_flash)},
                      {"wears", into(out.wears)},
                      {"unlock", into(out.unlock)},
                      {"unlock_open", into(out.unlock_open)},
                      {"unlock_closed", into(out.unlock_closed)},
                      {"locked", into(out.locked)},
                      {"defers_standstill", into(out.defers_standstill)}});
}

Result<void> read_restart(const TableReader& reader, Rules& rules) {
  return reader.read({{"restore_defaults", into(rules.store.restore_at_start)},
                      {"clear_alarms", into(rules.store.clear_alarms_at_start)}});
}

Result<void> read_mirror(const TableReader& reader, Rules& rules) {
  return reader.read({{"add_node_id", into(rules.mirror_add_node_id)}});
}

Result<void> read_statusword(const TableReader& reader, Rules& rules) {
  const auto word = [&](DriveState state) { return into(rules.statusword[static_cast<std::size_t>(state)]); };
  return reader.read({{"not_ready_to_switch_on", word(DriveState::not_ready_to_switch_on)},
                      {"switch_on_disabled", word(DriveState::switch_on_disabled)},
                      {"ready_to_switch_on", word(DriveState::ready_to_switch_on)},
                      {"switched_on", word(DriveState::switched_on)},
                      {"operation_enabled", word(DriveState::operation_enabled)},
                      {"quick_stop_active", word(DriveState::quick_stop_active)},
                      {"fault_reaction_active", word(DriveState::fault_reaction_active)},
                      {"fault", word(DriveState::fault)},
                      {"remote_bit", into(rules.remote_bit)},
                      {"mode_bits", list_into(rules.mode_bits, "[{ mode = 1, disabled = 0x0400 }]")}});
}

Result<void> read_quick_stop(const TableReader& reader, Rules& rules) {
  return reader.read(
      {{"stays_enabled", into(rules.quick_stop_stays_enabled)},
       {"ramps", [&](const toml::node& n) { return read_numbered(n, rules.quick_stop_ramps); }}});
}

Result<void> read_motion(const TableReader& reader, Rules& rules) {
  auto& out = rules.motion;
  return reader.read(
      {{"position", into(out.position)},
       {"velocity", into(out.velocity)},
       {"torque", into(out.torque)},
       {"homing", into(out.homing)},
       {"enable", into(out.enable)},
       {"start_homing", into(out.start_homing)},
       {"homing_done_mask", into(out.homing_done_mask)},
       {"homing_done", into(out.homing_done)},
       {"homing_error", into(out.homing_error)},
       {"encoder", into(out.encoder)},
       {"homed_bit", into(out.homed_bit)},
       {"halt", into(out.halt)},
       {"handshake", into(out.handshake)},
       {"speed_monitor", into(out.speed_monitor)},
       {"interpolation_ms", [&](const auto& n) { return get_range(n, out.interpolation_ms); }},
       {"position_speed", into(out.position_speed)},
       {"rated_speed", into(out.rated_speed)},
       {"rated_torque", into(out.rated_torque)},
       {"inputs_active_low",
        [&](const auto& n) {
          out.inputs_known = true;
          return into(out.inputs_active_low)(n) &&
                 std::all_of(out.inputs_active_low.begin(), out.inputs_active_low.end(),
                             [](std::uint8_t bit) { return bit < 32; });
        }},
       {"inputs",
        [&](const auto& n) {
          out.inputs_known = true;
          return into(out.inputs)(n) && out.inputs.size() == 3;
        }},
       {"no_homing", into(out.no_homing)},
       {"homing_like", [&](const toml::node& n) { return read_numbered(n, out.homing_like); }},
       {"software_limits", condition_into(out.software_limits)},
       {"software_limits_homed", into(out.software_limits_homed)},
       {"zero_ramp", into(out.zero_ramp)},
       {"speed_limit", into(out.speed_limit)},
       {"setpoints", into(out.setpoints)},
       {"without_controlword",
        list_into(out.without_controlword, R"([{ name = "P1-01", end = "P1-01", value = 0 }])")}});
}

Result<void> read_emergency(const TableReader& reader, Rules& rules) {
  auto& out = rules.emergency;
  const auto byte = [](std::uint8_t& place) {
    return [&place](const toml::node& n) { return get_int(n, place) && place >= 3 && place <= 7; };
  };
  return reader.read(
      {{"drive_alarm", into(out.drive_alarm)},
       {"size", [&](const auto& n) { return get_int(n, out.size) && out.size >= 2 && out.size <= 8; }},
       {"panel", into(out.panel)},
       {"major_byte", byte(out.major_byte)},
       {"minor_byte", byte(out.minor_byte)}});
}

Result<void> read_fault(const TableReader& reader, Rules& rules) {
  auto& out = rules.fault;
  return reader.read({{"reset_enabled_by", condition_into(out.reset_enabled_by)},
                      {"reset", list_into(out.reset, kSettings)},
                      {"by_controlword", into(out.by_controlword)},
                      {"alarm", into(out.alarm)},
                      {"ramp", into(out.ramp)},
                      {"length_alarm", into(out.length_alarm)},
                      {"mapping_alarm", into(out.mapping_alarm)},
                      {"range_alarm", into(out.range_alarm)},
                      {"access_alarm", into(out.access_alarm)},
                      {"object_alarm", into(out.object_alarm)},
                      {"sub_index_alarm", into(out.sub_index_alarm)},
                      {"following_alarm", into(out.following_alarm)}});
}

}  // namespace servoctl::drive
