#include "od/eds_object.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <string>
#include <unordered_set>

#include "base/text.hpp"
#include "od/eds_entry.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

void tell_duplicate_key(const IniKey& key, Findings& findings) {
  if (!findings.enough_of("duplicate-key"))
    findings.warn(key, "duplicate-key",
                  fmt::format("{} stands here again; the last one counts", shown(key.key)),
                  "remove one of them");
}

struct NocaseHash {
  std::size_t operator()(std::string_view text) const { return std::hash<std::string>{}(lower(text)); }
};

struct NocaseEqual {
  bool operator()(std::string_view a, std::string_view b) const { return equals_nocase(a, b); }
};

/// Whether every sub-index has decimal digits only, and hexadecimal reading is out of the question (one would
/// be above FF) or gives gaps where decimal reading has none.
bool are_decimal(std::span<const ObjectSection> sections) {
  std::array<bool, 256> there{};
  std::size_t highest = 0;
  bool too_high = false;
  for (const auto& place : sections) {
    if (place.name.kind != SectionKind::sub) continue;
    if (!place.name.decimal_sub) return false;
    there[*place.name.decimal_sub] = true;
    highest = std::max<std::size_t>(highest, *place.name.decimal_sub);
    too_high = too_high || place.name.sub > 0xFF;
  }
  if (highest <= 9 || too_high) return too_high;
  return std::all_of(there.begin() + 1, there.begin() + static_cast<std::ptrdiff_t>(highest),
                     [](bool is_there) { return is_there; });
}

void tell_decimal(const IniSection& section, std::uint16_t index, Findings& findings) {
  findings.add(
      Severity::warning, section.line, 1, "decimal-sub-index",
      fmt::format("the sub-indexes of {:04X} are taken as decimal: hexadecimal makes no sense", index),
      "write sub-indexes in hexadecimal: ten is subA");
}

void tell_too_high(const IniSection& section, Findings& findings) {
  if (!findings.enough_of("unknown-section"))
    findings.add(Severity::warning, section.line, 1, "unknown-section",
                 fmt::format("[{}]: the sub-index is above FF", section.name),
                 "write sub-indexes in hexadecimal: ten is subA");
}

void check_sub_number(const IniSection& section, const ObjectSections& sections, Findings& findings) {
  const auto* key = section.find("SubNumber");
  const auto count = sections.subs.size();
  if (key == nullptr || key->value.empty()) {
    findings.add(Severity::warning, section.line, 1, "missing-sub-number",
                 fmt::format("[{}] has no SubNumber", section.name), fmt::format("add SubNumber={}", count));
    return;
  }
  const auto number = eds_number(*key, 256, findings);
  if (number && *number != count)
    findings.warn(*key, "wrong-sub-number",
                  fmt::format("SubNumber is {}, but [{}] has {} sub-indexes", *number, section.name, count),
                  fmt::format("write SubNumber={}", count));
}

void add_entry(const IniSection& section, ObjectAddress address, Object& object,
               std::vector<EntryNote>& notes, Findings& findings) {
  auto entry = eds_entry(section, address, findings);
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
                 fmt::format("[{}] stands here again, first in line {}; the first one counts",
                             shown(again.name), first.line),
                 "remove one of them");
}

ObjectSections group_sections(std::span<const ObjectSection> sections, Findings& findings) {
  ObjectSections out;
  if (sections.size() == 1 && sections.front().name.kind == SectionKind::object) {
    out.main = sections.front().section;
    return out;
  }
  std::array<const IniSection*, 256> subs{};
  const bool decimal = are_decimal(sections);
  for (const auto& place : sections) {
    const bool is_sub = place.name.kind == SectionKind::sub;
    const std::size_t sub = decimal ? place.name.decimal_sub.value_or(0) : place.name.sub;
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
  if (decimal) tell_decimal(*out.subs.front().second, sections.front().name.index, findings);
  return out;
}

Object eds_object(std::uint16_t index, const ObjectSections& sections, const CompactLists& lists,
                  std::vector<EntryNote>& notes, Findings& findings) {
  Object object;
  object.index = index;
  if (sections.main != nullptr) {
    if (const auto* name = sections.main->find("ParameterName")) object.name = name->value;
    object.code = eds_object_code(*sections.main, findings);
  } else if (!sections.subs.empty()) {
    const auto& first = *sections.subs.front().second;
    findings.add(Severity::error, first.line, 1, "missing-object",
                 fmt::format("[{}] has no section [{:04X}]", first.name, index),
                 "add the section of the object");
  }
  const bool compact = sections.main != nullptr && has_compact_subs(*sections.main);
  const bool single = object.code == ObjectCode::var || object.code == ObjectCode::domain ||
                      object.code == ObjectCode::deftype;
  if (sections.subs.empty() && single && !compact) {
    if (sections.main != nullptr) add_entry(*sections.main, {index, 0}, object, notes, findings);
    return object;
  }
  for (const auto& sub : sections.subs) add_entry(*sub.second, {index, sub.first}, object, notes, findings);
  if (compact)
    add_compact_subs(*sections.main, lists, object, notes, findings);
  else if (sections.main != nullptr)
    check_sub_number(*sections.main, sections, findings);
  return object;
}

}  // namespace servoctl::od
