#include "show/drive_rules.hpp"

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/provenance.hpp"
#include "drive/standard_objects.hpp"
#include "show/caution_text.hpp"
#include "show/provenance_record.hpp"
#include "show/records.hpp"

namespace servoctl::show {
namespace {

using drive::Quotient;
using drive::Rules;
using report::Hex;
using report::List;
using report::Record;
using report::Show;
using report::Value;

template <class T>
Value list_of(const std::vector<T>& all) {
  List out;
  for (const auto& one : all) out.emplace_back(one);
  return out.empty() ? Value() : Value(std::move(out));
}

Value words_list(const std::vector<std::uint16_t>& controlwords) {
  List out;
  for (const auto word : controlwords) out.emplace_back(Hex{word, 4});
  return out;
}

Value settings(const std::vector<drive::Setting>& settings) {
  List out;
  for (const auto& setting : settings) out.emplace_back(formatted("{} = {}", setting.name, setting.value));
  return out.empty() ? Value() : Value(std::move(out));
}

template <class T>
Value optional(const std::optional<T>& value) {
  return value ? Value(*value) : Value();
}

std::string product(const std::vector<Quotient::Factor>& factors) {
  std::string out;
  for (const auto& factor : factors) {
    if (!out.empty()) out += " × ";
    if (const auto* object = std::get_if<ObjectAddress>(&factor))
      out += to_string(*object);
    else
      out += plain_number(std::get<double>(factor), 6);
  }
  return out.empty() ? "1" : out;
}

Value units(const Rules& rules) {
  Record out;
  const std::pair<drive::Measure, const char*> names[] = {
      {drive::Measure::increments_per_turn, "increments_per_turn"},
      {drive::Measure::pulses_per_turn, "pulses_per_turn"},
      {drive::Measure::rated_torque, "rated_torque"}};
  bool known = !rules.learn.speed.empty();
  const auto add = [&](const char* name, bool is, const std::string& text) {
    known = known || is;
    out.push_back({name, is ? Value(text) : Value(), is ? report::Show::everywhere : report::Show::json});
  };
  for (const auto& [measure, name] : names) {
    const auto found = rules.units.find(measure);
    const bool is = found != rules.units.end();
    add(name, is, is ? ways_text(found->second) : std::string());
  }
  add("measured", !rules.learn.speed.empty(), formatted("by `units learn`, against {}", rules.learn.speed));
  return known ? Value(std::move(out)) : Value();
}

Value identity(const Rules& rules) {
  List out;
  for (const auto& mark : rules.identity) {
    auto text = mark.text.empty() ? formatted("{} = 0x{:X}", to_string(mark.object), mark.value)
                                  : formatted("{} = \"{}\"", to_string(mark.object), mark.text);
    if (mark.mask != ~std::uint64_t{0}) text += formatted(" in the bits 0x{:X}", mark.mask);
    out.emplace_back(std::move(text));
  }
  return out.empty() ? Value("none: name the drive with -d") : Value(std::move(out));
}

Value numbering(const Rules& rules) {
  List out;
  for (const auto& rule : rules.numbering) {
    const auto names = rule.prefix + (rule.group != 0 ? "a.bc" : rule.base == 16 ? "hex" : "n");
    out.emplace_back(rule.unlisted ? formatted("{} from 0x{:04X} on, unlisted numbers too", names, rule.index)
                                   : formatted("{} from 0x{:04X} on", names, rule.index));
  }
  return out.empty() ? Value() : Value(std::move(out));
}

std::string_view text(drive::PdoRules::When when) {
  switch (when) {
    case drive::PdoRules::When::always: return "always";
    case drive::PdoRules::When::invalid: return "while the PDO is invalid";
    case drive::PdoRules::When::not_operational: return "outside Operational";
  }
  return "always";
}

Value pdo(const Rules& rules) {
  const auto& r = rules.pdo;
  std::vector<std::string> presets;
  for (const auto& preset : r.presets) presets.push_back(preset.name);
  Record types;
  for (const auto& [type, meaning] : r.types) types.push_back({formatted("type {}", type), meaning});
  // A drive whose PDOs are assigned by an object (CoE) has no COB-IDs.
  Record out{{"cob_id_bits", r.assign_rpdo.empty() ? Value(Hex{r.cob_id_bits, 8}) : Value(), Show::everywhere,
              "COB-ID bits that may change"},
             {"parameters", text(r.parameters), Show::everywhere, "type and times change"},
             {"mapping", r.disable_by_count ? "always, by count 0" : text(r.mapping)},
             {"most_entries", r.most_entries, Show::everywhere, "entries at most"},
             {"most_bits", r.most_bits, Show::everywhere, "bits at most"},
             {"clears_entries", r.clears_entries, Show::json},
             {"mapped_abort", Hex{r.mapped_abort, 8}, Show::json},
             {"presets", list_of(presets), Show::everywhere, "recommended mappings"},
             {"refused_types", list_of(r.refused_types), Show::everywhere, "types refused"},
             {"assign_rpdo", report::text_or_null(r.assign_rpdo), Show::everywhere, "RPDO assignment"},
             {"assign_tpdo", report::text_or_null(r.assign_tpdo), Show::everywhere, "TPDO assignment"}};
  for (auto& type : types) out.push_back(std::move(type));
  return out;
}

/// Where the manual does not list the objects of CiA 301, the drive is asked all the same, and its refusal
/// told.
std::string_view store_objects(const drive::Profile& profile) {
  if (!profile.rules.store.objects) return "no 1010h";
  return profile.dictionary.object(objects::kStoreIndex) != nullptr
             ? "1010h and 1011h"
             : "1010h and 1011h are tried, its manual does not list them";
}

Value store(const drive::Profile& profile) {
  const auto& r = profile.rules.store;
  return Record{{"objects", store_objects(profile), Show::text, "by object"},
                {"objects", r.objects, Show::json},
                {"store", settings(r.store)},
                {"restore", settings(r.restore)},
                {"flash_switch", report::text_or_null(r.flash_switch), Show::everywhere, "flash switch"},
                {"to_ram", optional(r.to_ram), Show::everywhere, "to RAM"},
                {"to_flash", optional(r.to_flash), Show::everywhere, "to flash"},
                {"wears", r.wears, Show::everywhere, "writes wear the flash"},
                {"unlock", report::text_or_null(r.unlock), Show::everywhere, "password"},
                {"unlock_open", optional(r.unlock_open), Show::everywhere, "password opens"},
                {"locked", list_of(r.locked)},
                {"restore_at_start", report::text_or_null(r.restore_at_start), Show::everywhere,
                 "restores at the next start"}};
}

/// Null for a family whose data name no registers.
Value modbus(const Rules& rules, bool chinese) {
  const auto& r = rules.modbus;
  if (!r.exists()) return {};
  std::string text;
  List blocks;
  for (const auto& block : r.registers) {
    append(text, formatted("{:04X}h-{:04X}h in {:04X}h-{:04X}h", block.index, block.index + block.count - 1,
                           block.at, block.at + block.count - 1));
    blocks.emplace_back(Record{{"index", block.index}, {"count", block.count}, {"at", block.at}});
  }
  return Record{{"registers", text, Show::text, "objects in registers"},
                {"registers", std::move(blocks), Show::json},
                {"node_id", report::text_or_null(r.node_id), Show::everywhere, "address in"},
                {"baud", report::text_or_null(r.baud), Show::everywhere, "speed in"},
                {"framing", report::text_or_null(r.framing), Show::everywhere, "RTU or ASCII in"},
                {"silence_ms", r.silence_ms, Show::everywhere, "silence (ms)"},
                {"at_rest", list_of(r.at_rest), Show::everywhere, "0 at rest"},
                {"targets", list_of(r.targets), Show::everywhere, "targets"},
                {"motion", report::text_or_null(chinese && !r.motion_zh.empty() ? r.motion_zh : r.motion)}};
}

Value motion(const Rules& rules) {
  const auto& r = rules.motion;
  std::vector<std::string> power_parameters;
  for (const auto& parameter : r.without_controlword) power_parameters.push_back(parameter.name);
  return Record{
      {"position", optional(r.position), Show::everywhere, "position mode"},
      {"velocity", optional(r.velocity), Show::everywhere, "velocity mode"},
      {"torque", optional(r.torque), Show::everywhere, "torque mode"},
      {"homing", r.homing ? Value(*r.homing) : Value(), Show::json},
      {"homing", r.homing ? Value(*r.homing) : Value("none"), Show::text, "homing mode"},
      {"enable", words_list(r.enable)},
      {"start_homing", r.homing ? words_list(r.start_homing) : Value(), Show::everywhere, "start homing"},
      {"halt", r.halt, Show::everywhere, "halt bit"},
      {"quick_stop_stays_enabled", list_of(rules.quick_stop_stays_enabled), Show::everywhere,
       "605Ah that stays energised"},
      {"inputs_active_low", list_of(r.inputs_active_low), Show::everywhere, "60FDh bits, 0 when on"},
      {"speed_limit", list_of(r.speed_limit), Show::everywhere, "speed limit in torque mode"},
      {"without_controlword", list_of(power_parameters), Show::everywhere, "energises without 6040h"}};
}

Value fault(const Rules& rules) {
  const auto& r = rules.fault;
  return Record{
      {"by_controlword", r.by_controlword, Show::everywhere, "reset by controlword"},
      {"reset_enabled_by",
       r.reset_enabled_by
           ? Value(formatted("{} = {}", to_string(r.reset_enabled_by->object), r.reset_enabled_by->value))
           : Value(),
       Show::everywhere, "reset allowed by"},
      {"reset", settings(r.reset), Show::everywhere, "also reset by"},
      {"alarm", report::text_or_null(r.alarm), Show::everywhere, "alarm number in"},
      {"emergency_size", rules.emergency.size, Show::everywhere, "EMCY bytes"},
      {"panel", report::text_or_null(rules.emergency.panel), Show::everywhere, "EMCY names the panel's"}};
}

Value cautions(const drive::Profile& profile, bool chinese) {
  List out;
  for (const auto& caution : profile.rules.cautions)
    out.emplace_back(caution_text(profile, caution, chinese));
  return out;
}

/// As a paragraph: sentences in a row, a list would put commas between them.
Value cautions_text(const drive::Profile& profile, bool chinese) {
  std::string out;
  for (const auto& caution : profile.rules.cautions)
    append(out, caution_text(profile, caution, chinese), " ");
  return report::text_or_null(out);
}

}  // namespace

std::string way_text(const drive::Quotient& way) {
  std::string out;
  if (!way.learned || !way.multiply.empty()) append(out, product(way.multiply), " × ");
  for (const auto object : way.power_of_two) append(out, formatted("2^{}", to_string(object)), " × ");
  if (!way.divide.empty()) out += " / (" + product(way.divide) + ")";
  if (way.learned) out = out.empty() ? "measured" : formatted("measured × {}", out);
  std::string conditions;
  for (const auto& condition : way.when)
    append(conditions, formatted("{} = {}", to_string(condition.object), condition.value));
  if (!conditions.empty()) out += formatted(" (when {})", conditions);
  return out + (way.assumed ? " (assumed)" : "");
}

std::string ways_text(const drive::Quotients& ways) {
  std::string out;
  for (const auto& way : ways) append(out, way_text(way), "; ");
  return out;
}

/// What puts a new node-ID or bitrate in force; empty where the family has no parameter of them.
Value address_after(const drive::NmtRules& rules) {
  if (rules.node_id.empty() && rules.bitrate.empty()) return {};
  return drive::name(rules.address_after);
}

Record rules_record(const drive::Profile& profile, bool chinese) {
  const auto& rules = profile.rules;
  Record out{{"family", profile.family},
             {"parent", report::text_or_null(rules.parent)},
             {"vendor", rules.vendor},
             {"name", chinese && !rules.name_zh.empty() ? rules.name_zh : rules.name},
             {"provenance", drive::provenance_text(profile, chinese), Show::text, "checked against"},
             {"provenance", provenance_record(drive::provenance_of(profile)), Show::json},
             {"objects", profile.dictionary.objects().size()},
             {"entries", profile.dictionary.entry_count()},
             {"parameters", profile.parameters.size()},
             {"faults", profile.faults.size()},
             {"identity", identity(rules)},
             {"numbering", numbering(rules), Show::everywhere, "panel numbers"},
             {"node_id", report::text_or_null(rules.nmt.node_id), Show::everywhere, "node-ID in"},
             {"bitrate", report::text_or_null(rules.nmt.bitrate), Show::everywhere, "bitrate in"},
             {"address_after", address_after(rules.nmt), Show::everywhere, "they hold after"},
             {"needs", settings(rules.nmt.needs), Show::everywhere, "needs for CANopen"},
             {"disables_outside_operational", rules.nmt.disables_outside_operational, Show::everywhere,
              "off outside Operational"},
             {"segmented", rules.sdo.segmented, Show::everywhere, "segmented SDO"},
             {"exact_length", rules.sdo.exact_length, Show::everywhere, "exact SDO length"},
             {"units", units(rules)},
             {"pdo", pdo(rules), Show::everywhere, "PDO"},
             {"modbus", modbus(rules, chinese), Show::everywhere, "Modbus"},
             {"store", store(profile), Show::everywhere, "storing"},
             {"motion", motion(rules)},
             {"fault", fault(rules), Show::everywhere, "faults and emergencies"},
             {"cautions", cautions_text(profile, chinese), Show::text, "before motion"},
             {"cautions", cautions(profile, chinese), Show::json},
             {"assumed", list_of(rules.assumed), Show::everywhere, "not in the manual"},
             {"contradicted", report::text_or_null(od::to_text(rules.contradicted)), Show::text,
              "the manual is inconsistent on"},
             {"contradicted", marks_record(rules.contradicted), Show::json}};
  return out;
}

}  // namespace servoctl::show
