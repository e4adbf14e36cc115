#include "od/eds_object.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <unordered_set>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/pdo_index.hpp"
#include "base/text.hpp"
#include "od/eds_entry.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

void tell_duplicate_key(const IniKey& key, Findings& findings) {
  if (!findings.enough_of("duplicate-key"))
    findings.warn(key, "duplicate-key", formatted("{} appears again; the last one is used", shown(key.key)),
                  "remove one of them");
}

struct NocaseHash {
  std::size_t operator()(std::string_view text) const { return std::hash<std::string>{}(lower(text)); }
};

struct NocaseEqual {
  bool operator()(std::string_view a, std::string_view b) const { return equals_nocase(a, b); }
};

/// What sub 0 says is the highest sub-index.
std::optional<std::uint64_t> said_highest(std::span<const ObjectSection> sections) {
  for (const auto& place : sections) {
    if (place.name.kind != SectionKind::sub || place.name.sub != 0) continue;
    const auto* key = place.section->find("DefaultValue");
    const auto number = key == nullptr ? std::nullopt : parse_integer(key->value);
    return number ? number->as_unsigned() : std::nullopt;
  }
  return std::nullopt;
}

/// How the digits of sub-indexes are meant, and why.
struct Digits {
  bool decimal = false;
  std::string_view why = {};  ///< Empty where nothing is to be told.
};

/// Sub-indexes of decimal digits only are decimal when one would be above FF in hexadecimal, when the highest
/// is then what sub 0 says, or when sub 0 says neither and decimal reading gives no gaps.
Digits digits_of(std::span<const ObjectSection> sections) {
  std::array<bool, 256> there{};
  std::size_t highest = 0;
  std::size_t highest_hex = 0;
  for (const auto& place : sections) {
    if (place.name.kind != SectionKind::sub) continue;
    if (!place.name.decimal_sub) return {};
    there[*place.name.decimal_sub] = true;
    highest = std::max<std::size_t>(highest, *place.name.decimal_sub);
    highest_hex = std::max<std::size_t>(highest_hex, place.name.sub);
  }
  if (highest_hex > 0xFF) return {true, "in hexadecimal one is above FF"};
  if (highest <= 9) return {};
  const bool whole = std::all_of(there.begin() + 1, there.begin() + static_cast<std::ptrdiff_t>(highest),
                                 [](bool is_there) { return is_there; });
  const auto said = said_highest(sections);
  if (said == highest_hex) return {false, whole ? "as sub 0 says" : ""};
  if (said == highest) return {true, "as sub 0 says"};
  return whole ? Digits{true, "in hexadecimal some are missing"} : Digits{};
}

void tell_digits(const IniSection& section, std::uint16_t index, const Digits& digits, Findings& findings) {
  if (digits.why.empty()) return;
  findings.add(Severity::warning, section.line, 1,
               digits.decimal ? "decimal-sub-index" : "hexadecimal-sub-index",
               formatted("the sub-indexes of {:04X} are taken as {}: {}", index,
                         digits.decimal ? "decimal" : "hexadecimal, sub10 is sixteen", digits.why),
               "write sub-indexes in hexadecimal: ten is subA");
}

void tell_too_high(const IniSection& section, Findings& findings) {
  if (!findings.enough_of("unknown-section"))
    findings.add(Severity::warning, section.line, 1, "unknown-section",
                 formatted("[{}]: the sub-index is above FF", section.name),
                 "write sub-indexes in hexadecimal: ten is subA");
}

void check_sub_number(const IniSection& section, const ObjectSections& sections, Findings& findings) {
  const auto* key = section.find("SubNumber");
  const auto count = sections.subs.size();
  if (count == 0) {
    findings.add(Severity::warning, section.line, 1, "no-sub-indexes",
                 formatted("[{}] has neither sub-indexes nor CompactSubObj; it is ignored", section.name),
                 "add the sections of its sub-indexes, or write ObjectType=0x7 when it is one value");
    return;
  }
  if (key == nullptr || key->value.empty()) {
    findings.add(Severity::warning, section.line, 1, "missing-sub-number",
                 formatted("[{}] has no SubNumber", section.name), formatted("add SubNumber={}", count));
    return;
  }
  const auto number = eds_number(*key, 256, findings);
  if (number && *number != count)
    findings.warn(*key, "wrong-sub-number",
                  formatted("SubNumber is {}, but [{}] has {} sub-indexes", *number, section.name, count),
                  formatted("write SubNumber={}", count));
}

/// Whether sub 0 may say more than there is: multiplexed PDOs are marked so, the communication record of a
/// PDO has six places of which few are used (CiA 301, 7.5.2.33), 1029h counts classes of errors.
bool may_say_more(std::uint16_t index, double said) {
  return (is_pdo_mapping(index) && said >= 0xFE) || (is_pdo_communication(index) && said <= 6) ||
         index == 0x1029;
}

void check_sub_0(const Object& object, const IniSection& main, const ObjectSections& sections,
                 Findings& findings) {
  constexpr std::uint8_t kStructure = 0xFF;  // Is no entry (CiA 301, 7.4.5.2).
  if (sections.subs.front().first != 0) {
    findings.add(Severity::warning, main.line, 1, "missing-sub-0",
                 formatted("[{}] has no sub 0 (highest sub-index supported)", main.name),
                 "add the section of sub 0: a u8");
    return;
  }
  const auto& section = *sections.subs.front().second;
  if (object.entries.empty() || object.entries.front().address.sub != 0) return;
  const auto& entry = object.entries.front();
  const auto tell = [&](std::string_view key, std::string_view rule, std::string message,
                        std::string remedy) {
    const auto* at = section.find(key);
    findings.add(Severity::warning, at != nullptr ? at->line : section.line,
                 at != nullptr ? at->value_column : 1, rule, std::move(message), std::move(remedy));
  };
  if (entry.type != DataType::u8)
    tell("DataType", "sub-0-type",
         formatted("[{}] is {}; sub 0 is u8 by CiA 301; taken as written", section.name, name(entry.type)),
         "write DataType=0x0005");
  auto highest = sections.subs.back().first;
  if (highest == kStructure && sections.subs.size() > 1)
    highest = sections.subs[sections.subs.size() - 2].first;
  if (!entry.default_value || entry.default_value->plus_node_id || !is_integer(entry.type)) return;
  const auto said = to_double(entry.default_value->value);
  // A list that is filled at run time, or by the user, begins with less than it has room for.
  const bool fixed = !writable(entry.access) && object.index != 0x1003 && !is_pdo_mapping(object.index);
  if ((said > highest && !may_say_more(object.index, said)) || (fixed && said < highest))
    tell("DefaultValue", "sub-0-value",
         formatted("[{}] says the highest sub-index is {}; it is {}", section.name,
                   to_string(entry.default_value->value), highest),
         formatted("write DefaultValue={}", highest));
}

void add_entry(const IniSection& section, ObjectAddress address, const LimitTypes& types, Object& object,
               std::vector<EntryNote>& notes, Findings& findings) {
  auto entry = eds_entry(section, address, types, findings);
  if (!entry) return;
  object.entries.push_back(std::move(*entry));
  const auto text = [&](std::string_view name) {
    const auto* key = section.find(name);
    return key == nullptr ? std::string() : std::string(key->value);
  };
  EntryNote note{address, text("Denotation"), text("UploadFile"), text("DownloadFile")};
  if (!note.denotation.empty() || !note.upload_file.empty() || !note.download_file.empty())
    notes.push_back(std::move(note));
}

void tell_var_with_subs(const IniSection& main, Findings& findings) {
  const auto* key = main.find("ObjectType");
  const bool said = key != nullptr && !key->value.empty();
  findings.add(Severity::warning, said ? key->line : main.line, said ? key->value_column : 1,
               "var-with-sub-indexes",
               formatted("[{}] {} and has sub-indexes; these are taken, the object is read as a record",
                         main.name, said ? "is a VAR" : "has no ObjectType, which means VAR,"),
               "write ObjectType=0x9, or 0x8 for an array, or remove the sub-indexes");
}

}  // namespace

void check_duplicate_keys(const IniSection& section, Findings& findings) {
  constexpr std::size_t kFew = 16;
  constexpr std::size_t kMost = 100'000;  // Above any list of objects.
  const auto keys = section.keys.first(std::min(section.keys.size(), kMost));
  if (keys.size() > kFew) {
    std::unordered_set<std::string_view, NocaseHash, NocaseEqual> seen;
    for (const auto& key : keys)
      if (!seen.insert(key.key).second) tell_duplicate_key(key, findings);
    return;
  }
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (std::any_of(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(i), [&](const IniKey& before) {
          return before.key.size() == keys[i].key.size() && equals_nocase(before.key, keys[i].key);
        }))
      tell_duplicate_key(keys[i], findings);
}

void tell_duplicate(const IniSection& again, const IniSection& first, Findings& findings) {
  if (!findings.enough_of("duplicate-section"))
    findings.add(Severity::error, again.line, 1, "duplicate-section",
                 formatted("[{}] appears again, first in line {}; the first one is used", shown(again.name),
                           first.line),
                 "remove one of them");
}

ObjectSections group_sections(std::span<const ObjectSection> sections, Findings& findings) {
  ObjectSections out;
  if (sections.size() == 1 && sections.front().name.kind == SectionKind::object) {
    out.main = sections.front().section;
    return out;
  }
  std::array<const IniSection*, 256> subs{};
  const auto digits = digits_of(sections);
  for (const auto& place : sections) {
    const bool is_sub = place.name.kind == SectionKind::sub;
    const std::size_t sub = digits.decimal ? place.name.decimal_sub.value_or(0) : place.name.sub;
    if (is_sub && sub >= subs.size()) {
      tell_too_high(*place.section, findings);
      continue;
    }
    auto*& first = is_sub ? subs[sub] : out.main;
    if (first == nullptr)
      first = place.section;
    else
      tell_duplicate(*place.section, *first, findings);
  }
  for (std::size_t sub = 0; sub < subs.size(); ++sub)
    if (subs[sub] != nullptr) out.subs.emplace_back(static_cast<std::uint8_t>(sub), subs[sub]);
  if (!out.subs.empty()) tell_digits(*out.subs.front().second, sections.front().name.index, digits, findings);
  return out;
}

Object eds_object(std::uint16_t index, const ObjectSections& sections, const CompactLists& lists,
                  const LimitTypes& types, std::vector<EntryNote>& notes, Findings& findings) {
  Object object;
  object.index = index;
  if (sections.main != nullptr) {
    if (const auto* name = sections.main->find("ParameterName")) object.name = name->value;
    object.code = eds_object_code(*sections.main, findings);
  } else if (!sections.subs.empty()) {
    const auto& first = *sections.subs.front().second;
    findings.add(Severity::error, first.line, 1, "missing-object",
                 formatted("[{}] has no section [{:04X}]", first.name, index),
                 "add the section of the object");
  }
  const bool compact = sections.main != nullptr && has_compact_subs(*sections.main);
  const bool single = object.code == ObjectCode::var || object.code == ObjectCode::domain ||
                      object.code == ObjectCode::deftype;
  if (sections.subs.empty() && single && !compact) {
    if (sections.main != nullptr) add_entry(*sections.main, {index, 0}, types, object, notes, findings);
    return object;
  }
  if (single && sections.main != nullptr && !sections.subs.empty() && !compact)
    tell_var_with_subs(*sections.main, findings);
  for (const auto& sub : sections.subs)
    add_entry(*sub.second, {index, sub.first}, types, object, notes, findings);
  if (compact)
    add_compact_subs(*sections.main, lists, types, object, notes, findings);
  else if (sections.main != nullptr)
    check_sub_number(*sections.main, sections, findings);
  if (!compact && sections.main != nullptr && !sections.subs.empty())
    check_sub_0(object, *sections.main, sections, findings);
  return object;
}

}  // namespace servoctl::od
