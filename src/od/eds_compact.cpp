#include "od/eds_compact.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "od/eds_entry.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

constexpr std::uint64_t kMostPdos = 512;

Entry entry_of(ObjectAddress address, std::string name, DataType type, Access access,
               std::optional<Value> default_value) {
  Entry entry;
  entry.address = address;
  entry.name = std::move(name);
  entry.type = type;
  entry.access = access;
  if (default_value) entry.default_value = NodeValue{std::move(*default_value), false};
  return entry;
}

Entry count_entry(std::uint16_t index, std::uint64_t count, Access access) {
  return entry_of({index, 0}, "Highest sub-index supported", DataType::u8, access, Value(count));
}

bool has_sub(const Object& object, std::uint64_t sub) {
  return std::any_of(object.entries.begin(), object.entries.end(),
                     [&](const Entry& entry) { return entry.address.sub == sub; });
}

/// The keys of a list by their sub-index; the last of a number counts.
std::array<const IniKey*, 256> by_sub(const IniSection* list, std::uint64_t count, Findings& findings) {
  std::array<const IniKey*, 256> out{};
  if (list == nullptr) return out;
  for (const auto& key : list->keys) {
    if (equals_nocase(key.key, "NrOfEntries")) continue;
    const auto sub = parse_digits(key.key, 10);
    if (sub && *sub <= count)
      out[*sub] = &key;
    else if (!findings.enough_of("no-such-entry"))
      findings.warn(key, "no-such-entry",
                    formatted("[{}]: CompactSubObj has no entry '{}'", list->name, shown(key.key)),
                    formatted("use decimal numbers of 1 to {}", count));
  }
  return out;
}

struct PdoKind {
  std::string_view count_key;
  std::string_view word;
  std::uint16_t communication;
  std::uint16_t mapping;
  std::uint64_t first_cob_id;  ///< Of PDO 1 in the predefined connection set (CiA 301, 7.3.3); 0x100 apart.
};

constexpr std::array kPdoKinds{PdoKind{"NrOfRXPDO", "RPDO", 0x1400, 0x1600, 0x200},
                               PdoKind{"NrOfTXPDO", "TPDO", 0x1800, 0x1A00, 0x180}};

Object communication_object(const PdoKind& kind, std::uint16_t number, std::uint64_t mask) {
  constexpr std::uint64_t kUnused = 0x8000'0000;
  constexpr std::uint16_t kPredefined = 4;
  struct Sub {
    std::string_view name;
    DataType type;
  };
  static constexpr std::array kSubs{
      Sub{"COB-ID", DataType::u32},       Sub{"Transmission type", DataType::u8},
      Sub{"Inhibit time", DataType::u16}, Sub{"Compatibility entry", DataType::u8},
      Sub{"Event timer", DataType::u16},  Sub{"SYNC start value", DataType::u8}};
  const auto index = static_cast<std::uint16_t>(kind.communication + number);
  Object object{index, formatted("{} communication parameter", kind.word), ObjectCode::record, {}};
  object.entries.push_back(count_entry(index, 0, Access::constant));
  for (std::uint8_t bit = 0; bit < kSubs.size(); ++bit) {
    if ((mask >> bit & 1U) == 0) continue;
    const auto sub = static_cast<std::uint8_t>(bit + 1);
    object.entries.push_back(
        entry_of({index, sub}, std::string(kSubs[bit].name), kSubs[bit].type, Access::rw, std::nullopt));
    object.entries.front().default_value = NodeValue{Value(std::uint64_t{sub}), false};
  }
  if ((mask & 1U) != 0)
    object.entries[1].default_value = number < kPredefined
                                          ? NodeValue{Value(kind.first_cob_id + 0x100U * number), true}
                                          : NodeValue{Value(kUnused), false};
  return object;
}

Object mapping_object(const PdoKind& kind, std::uint16_t number, std::uint64_t entries) {
  const auto index = static_cast<std::uint16_t>(kind.mapping + number);
  Object object{index, formatted("{} mapping parameter", kind.word), ObjectCode::record, {}};
  object.entries.push_back(count_entry(index, 0, Access::rw));
  for (std::uint64_t sub = 1; sub <= entries; ++sub)
    object.entries.push_back(entry_of({index, static_cast<std::uint8_t>(sub)},
                                      formatted("Mapping entry {}", sub), DataType::u32, Access::rw,
                                      Value(std::uint64_t{0})));
  return object;
}

std::uint64_t number_of(const IniSection& section, std::string_view name, std::uint64_t max,
                        Findings& findings) {
  const auto* key = section.find(name);
  return key == nullptr || key->value.empty() ? 0 : eds_number(*key, max, findings).value_or(0);
}

/// 255 is 254: sub FFh tells the structure of the object (CiA 301, 7.4.5.2) and is no entry.
std::uint64_t compact_count(const IniKey& key, Findings& findings) {
  constexpr std::uint64_t kMost = 254;
  const auto count = eds_number(key, kMost + 1, findings).value_or(0);
  if (count > kMost)
    findings.warn(key, "compact-too-many", formatted("CompactSubObj is {}; taken as {}", count, kMost),
                  formatted("write CompactSubObj={}: sub FF is no entry", kMost));
  return std::min(count, kMost);
}

}  // namespace

bool has_compact_subs(const IniSection& section) {
  const auto* key = section.find("CompactSubObj");
  return key != nullptr && !key->value.empty() && parse_integer(key->value) != Integer{};
}

void add_compact_subs(const IniSection& section, const CompactLists& lists, const LimitTypes& types,
                      Object& object, std::vector<EntryNote>& notes, Findings& findings) {
  const auto count = compact_count(*section.find("CompactSubObj"), findings);
  if (count > lists.most && !findings.enough_of("too-many-entries")) {
    findings.error(*section.find("CompactSubObj"), "too-many-entries",
                   "with this one, CompactSubObj makes more entries than a device has; left out",
                   "lower the numbers");
  }
  const auto pattern = count == 0 || count > lists.most
                           ? std::nullopt
                           : eds_entry(section, ObjectAddress{object.index}, types, findings);
  if (!pattern) return;
  const auto names = by_sub(lists.names, count, findings);
  const auto values = by_sub(lists.values, count, findings);
  const auto denotations = by_sub(lists.denotations, count, findings);
  if (!has_sub(object, 0)) {
    object.entries.push_back(count_entry(object.index, count, Access::ro));
    object.entries.back().line = section.line;
  }
  for (std::uint64_t sub = 1; sub <= count; ++sub) {
    if (has_sub(object, sub)) continue;
    Entry entry = *pattern;
    entry.address.sub = static_cast<std::uint8_t>(sub);
    const auto* name = names[sub];
    entry.name = name != nullptr && !name->value.empty() ? std::string(name->value)
                                                         : formatted("{}{}", object.name, sub);
    if (auto value = eds_value(values[sub], entry.type, findings, ValueUse::written))
      entry.configured = std::move(value);
    if (denotations[sub] != nullptr && !denotations[sub]->value.empty())
      notes.push_back({entry.address, std::string(denotations[sub]->value), {}, {}});
    object.entries.push_back(std::move(entry));
  }
  std::ranges::sort(object.entries, {}, [](const Entry& entry) { return entry.address.sub; });
}

void add_compact_pdos(const IniSection& device_info, Dictionary& dictionary, Findings& findings) {
  const auto mask = number_of(device_info, "CompactPDO", 0xFF, findings);
  if (mask == 0) return;
  const auto granularity = number_of(device_info, "Granularity", 64, findings);
  const auto entries = granularity == 0 ? 8 : 64 / granularity;
  for (const auto& kind : kPdoKinds) {
    auto missing = number_of(device_info, kind.count_key, kMostPdos, findings);
    for (std::uint16_t number = 0; number < kMostPdos && missing > 0; ++number) {
      const auto is_there = [&](std::uint16_t base) {
        return dictionary.object(static_cast<std::uint16_t>(base + number)) != nullptr;
      };
      if (is_there(kind.communication) || is_there(kind.mapping)) --missing;
    }
    for (std::uint16_t number = 0; number < kMostPdos && missing > 0; ++number) {
      auto communication = communication_object(kind, number, mask);
      if (dictionary.object(communication.index) != nullptr) continue;
      auto mapping = mapping_object(kind, number, entries);
      if (dictionary.object(mapping.index) != nullptr) continue;
      dictionary.add(std::move(communication));
      dictionary.add(std::move(mapping));
      --missing;
    }
  }
}

}  // namespace servoctl::od
