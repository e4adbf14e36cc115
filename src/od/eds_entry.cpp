#include "od/eds_entry.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/offer.hpp"
#include "base/pdo_index.hpp"
#include "base/text.hpp"
#include "od/complex_type.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

struct AccessRow {
  std::string_view word;
  Access access;
  PdoMapping direction;  ///< When the entry may be mapped.
};

/// CiA 306-1, 4.6.2.4: rwr is mapped when read (TPDO), rww when written (RPDO).
constexpr std::array kAccess{
    AccessRow{"ro", Access::ro, PdoMapping::tpdo},  AccessRow{"rw", Access::rw, PdoMapping::both},
    AccessRow{"wo", Access::wo, PdoMapping::rpdo},  AccessRow{"const", Access::constant, PdoMapping::tpdo},
    AccessRow{"rwr", Access::rw, PdoMapping::tpdo}, AccessRow{"rww", Access::rw, PdoMapping::rpdo},
};

struct AccessSynonym {
  std::string_view written;
  std::string_view meant;
};

constexpr std::array kAccessSynonyms{
    AccessSynonym{"r", "ro"},         AccessSynonym{"w", "wo"},           AccessSynonym{"r/w", "rw"},
    AccessSynonym{"wr", "rw"},        AccessSynonym{"readonly", "ro"},    AccessSynonym{"writeonly", "wo"},
    AccessSynonym{"readwrite", "rw"}, AccessSynonym{"constant", "const"}, AccessSynonym{"cons", "const"}};

struct NamedCode {
  std::string_view name;
  std::uint16_t code;
};

/// CiA 301, tables 42 and 44.
constexpr std::array kObjectCodes{NamedCode{"DOMAIN", 2},  NamedCode{"DEFTYPE", 5}, NamedCode{"DEFSTRUCT", 6},
                                  NamedCode{"VAR", 7},     NamedCode{"ARRAY", 8},   NamedCode{"RECORD", 9},
                                  NamedCode{"VARIABLE", 7}};
constexpr std::array kTypeCodes{
    NamedCode{"BOOLEAN", 0x01},         NamedCode{"INTEGER8", 0x02},       NamedCode{"INTEGER16", 0x03},
    NamedCode{"INTEGER32", 0x04},       NamedCode{"UNSIGNED8", 0x05},      NamedCode{"UNSIGNED16", 0x06},
    NamedCode{"UNSIGNED32", 0x07},      NamedCode{"REAL32", 0x08},         NamedCode{"VISIBLE_STRING", 0x09},
    NamedCode{"OCTET_STRING", 0x0A},    NamedCode{"UNICODE_STRING", 0x0B}, NamedCode{"TIME_OF_DAY", 0x0C},
    NamedCode{"TIME_DIFFERENCE", 0x0D}, NamedCode{"DOMAIN", 0x0F},         NamedCode{"INTEGER24", 0x10},
    NamedCode{"REAL64", 0x11},          NamedCode{"INTEGER64", 0x15},      NamedCode{"UNSIGNED24", 0x16},
    NamedCode{"UNSIGNED64", 0x1B}};

/// A number, or its name in the standard, which the book does not allow and some files have.
template <std::size_t N>
std::optional<std::uint64_t> number_or_name(const IniKey& key, const std::array<NamedCode, N>& names,
                                            std::uint64_t max, Findings& findings) {
  for (const auto& row : names) {
    if (!equals_nocase(row.name, key.value)) continue;
    findings.warn(key, "name-for-number",
                  formatted("{}: '{}' is taken as 0x{:04X}", key.key, key.value, row.code),
                  formatted("write 0x{:04X}", row.code));
    return row.code;
  }
  return eds_number(key, max, findings);
}

/// The type that the section names, and the limits that come with it.
std::optional<LimitType> entry_type(const IniSection& section, const LimitTypes& types, Findings& findings) {
  const auto* key = section.find("DataType");
  if (key == nullptr || key->value.empty()) {
    const auto* code = section.find("ObjectType");
    if (code != nullptr && (parse_integer(code->value) == Integer{false, 2}))
      return LimitType{DataType::domain, {}, {}, {}};
    findings.add(Severity::error, section.line, 1, "missing-data-type",
                 formatted("[{}] has no DataType", section.name),
                 "add DataType, for example DataType=0x0007 for an unsigned number of 32 bits");
    return std::nullopt;
  }
  const auto code = number_or_name(*key, kTypeCodes, 0xFFFF, findings);
  if (!code) return std::nullopt;
  if (const auto found = types.find(static_cast<std::uint16_t>(*code)); found != types.end())
    return found->second;
  const auto type = data_type_from_cia(*code);
  if (!type) {
    findings.error(*key, "unknown-data-type", formatted("0x{:04X} is not a CiA 301 data type", *code),
                   "use one of 0x0001 to 0x001B (CiA 301, table 44)");
    return std::nullopt;
  }
  return LimitType{
      *type,
      {},
      {},
      is_complex_type(*code) ? formatted("{} ({:04X}h)", cia_name(*code), *code) : std::string()};
}

/// The row of the word; of a near one when only one is near (`r` → `ro`, `r/w` → `rw`); the ro row when it
/// is neither, because what is not known to be writable is not written.
const AccessRow& access_of(const IniKey& key, Findings& findings) {
  const auto text = without_comment(key, findings);
  for (const auto& row : kAccess)
    if (equals_nocase(row.word, text)) return row;
  for (const auto& synonym : kAccessSynonyms) {
    if (!equals_nocase(synonym.written, text)) continue;
    findings.warn(key, "access-spelling", formatted("'{}' is taken as {}", text, synonym.meant),
                  formatted("write {}", synonym.meant));
    return *std::find_if(kAccess.begin(), kAccess.end(),
                         [&](const AccessRow& row) { return row.word == synonym.meant; });
  }
  std::vector<std::string> words;
  for (const auto& row : kAccess) words.emplace_back(row.word);
  const auto guess = text.size() > 8 ? std::string() : did_you_mean(text, words).text();
  findings.error(key, "unknown-access-type",
                 formatted("'{}' is not an access type; taken as ro", shown(text)),
                 guess.empty() ? "write ro, rw, wo, const, rwr or rww" : guess);
  return kAccess[0];
}

void read_access(const IniSection& section, Entry& entry, Findings& findings) {
  const auto* key = section.find("AccessType");
  if (key == nullptr || key->value.empty())
    findings.add(Severity::error, section.line, 1, "missing-access-type",
                 formatted("[{}] has no AccessType; taken as ro", section.name),
                 "add AccessType=ro, rw, wo or const");
  const auto& row = key == nullptr || key->value.empty() ? kAccess[0] : access_of(*key, findings);
  entry.access = row.access;
  const auto* mapping = section.find("PDOMapping");
  if (mapping == nullptr || mapping->value.empty()) return;
  const auto mappable = eds_number(*mapping, 1, findings);
  if (mappable.value_or(0) == 1) entry.pdo = row.direction;
}

bool is_can_id(ObjectAddress object) {
  const bool sdo = object.index >= 0x1200 && object.index <= 0x12FF;
  return (is_pdo_communication(object.index) && object.sub == 1) ||
         (sdo && (object.sub == 1 || object.sub == 2)) ||
         (object.sub == 0 && (object.index == 0x1005 || object.index == 0x1012 || object.index == 0x1014));
}

/// A CAN-ID of 11 bits that is above 7FFh with every node-ID.
void check_can_id(const IniSection& section, const Entry& entry, Findings& findings) {
  constexpr std::uint64_t kExtended = 1U << 29U;
  constexpr std::uint64_t kCanId = kExtended - 1;
  constexpr std::uint64_t kHighest = 0x7FF;
  if (!is_can_id(entry.address)) return;
  for (const auto* name : {"DefaultValue", "ParameterValue"}) {
    const auto& value = name[0] == 'D' ? entry.default_value : entry.configured;
    const auto* number = value && value->plus_node_id ? std::get_if<std::uint64_t>(&value->value) : nullptr;
    if (number == nullptr || (*number & kExtended) != 0 || (*number & kCanId) + 1 <= kHighest) continue;
    const auto* key = section.find(name);
    findings.warn(*key, "node-id-sum",
                  formatted("{}: {} is above 7FFh for every node; taken as it is", name, shown(key->value)),
                  "lower the number, or set bit 29 for a CAN-ID of 29 bits");
  }
}

/// `HighLimit 0xFF (-1)`: as the file writes it, and what that is in the entry's type where it reads
/// otherwise.
std::string shown_limit(const IniSection& section, std::string_view name, const NodeValue& value) {
  const auto* key = section.find(name);
  const auto number = to_string(value.value);
  if (key == nullptr || key->value.empty()) return formatted("{} {}", name, number);
  if (value.plus_node_id || key->value == number) return formatted("{} {}", name, shown(key->value));
  return formatted("{} {} ({})", name, shown(key->value), number);
}

void check_order(const IniSection& section, Entry& entry, Findings& findings) {
  const auto tell = [&](std::string_view rule, const std::string& message) {
    findings.add(Severity::warning, section.line, 1, std::string(rule),
                 formatted("[{}]: {}", section.name, message), "correct LowLimit, HighLimit or DefaultValue");
  };
  const auto above = [](const std::optional<NodeValue>& a, const std::optional<NodeValue>& b) {
    return a && b && compare_numbers(a->for_node(1), b->for_node(1)) > 0;
  };
  if (above(entry.low, entry.high)) {
    tell("limits-crossed",
         formatted("{} is above {} in {}; neither is used", shown_limit(section, "LowLimit", *entry.low),
                   shown_limit(section, "HighLimit", *entry.high), name(entry.type)));
    entry.low.reset();
    entry.high.reset();
  }
  const bool below = above(entry.low, entry.default_value);
  if (below || above(entry.default_value, entry.high))
    tell("default-out-of-limits",
         formatted("{} is {} {}", shown_limit(section, "DefaultValue", *entry.default_value),
                   below ? "below" : "above",
                   below ? shown_limit(section, "LowLimit", *entry.low)
                         : shown_limit(section, "HighLimit", *entry.high)));
}

}  // namespace

ObjectCode eds_object_code(const IniSection& section, Findings& findings) {
  const auto* key = section.find("ObjectType");
  if (key == nullptr || key->value.empty()) return ObjectCode::var;
  const auto code = number_or_name(*key, kObjectCodes, 0xFF, findings);
  if (!code) return ObjectCode::var;
  const bool known = std::any_of(kObjectCodes.begin(), kObjectCodes.end(),
                                 [&](const NamedCode& row) { return row.code == *code; });
  if (known) return static_cast<ObjectCode>(*code);
  findings.error(*key, "unknown-object-type",
                 formatted("'{}' is not an object type; taken as VAR", shown(key->value)),
                 "write 0x7 for a variable, 0x8 for an array, 0x9 for a record");
  return ObjectCode::var;
}

std::optional<Entry> eds_entry(const IniSection& section, ObjectAddress address, const LimitTypes& types,
                               Findings& findings) {
  const auto found = entry_type(section, types, findings);
  if (!found) return std::nullopt;
  const auto type = found->type;
  Entry entry;
  entry.address = address;
  entry.type = type;
  entry.note = found->note;
  entry.line = section.line;
  const auto* name = section.find("ParameterName");
  if (name == nullptr || name->value.empty())
    findings.add(Severity::warning, section.line, 1, "missing-name",
                 formatted("[{}] has no ParameterName", section.name), "add ParameterName");
  else
    entry.name = std::string(name->value);
  read_access(section, entry, findings);
  entry.default_value = eds_value(section.find("DefaultValue"), type, findings);
  entry.low = eds_value(section.find("LowLimit"), type, findings, ValueUse::limit);
  entry.high = eds_value(section.find("HighLimit"), type, findings, ValueUse::limit);
  entry.configured = eds_value(section.find("ParameterValue"), type, findings, ValueUse::written);
  if (!entry.low && found->low) entry.low = NodeValue{*found->low, false};
  if (!entry.high && found->high) entry.high = NodeValue{*found->high, false};
  check_can_id(section, entry, findings);
  check_order(section, entry, findings);
  return entry;
}

}  // namespace servoctl::od
