#include "od/eds_lists.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

constexpr std::array<std::string_view, 3> kLists{"MandatoryObjects", "OptionalObjects",
                                                 "ManufacturerObjects"};

/// The list that the section is, maybe misspelt.
std::string_view list_of(const IniSection& section) {
  const auto name = std::string_view(section.name).substr(0, 40);
  return *std::min_element(kLists.begin(), kLists.end(), [&](std::string_view a, std::string_view b) {
    return edit_distance(name, a) < edit_distance(name, b);
  });
}

/// The list that an index belongs into; empty where more than one will do.
std::string_view right_list(std::uint64_t index) {
  if (index == 0x1000 || index == 0x1001 || index == 0x1018) return kLists[0];
  if (index >= 0x2000 && index <= 0x5FFF) return kLists[2];
  return {};
}

class Checker {
 public:
  Checker(const PresentObjects& present, Findings& findings) : present_(&present), findings_(&findings) {}

  void check(std::span<const IniSection* const> lists) {
    for (const auto* section : lists) check(*section);
    if (lists.empty()) return;
    for (const auto& object : present_->sections)
      if (object.second != nullptr && !listed_.contains(object.first))
        findings_->add(Severity::warning, object.second->line, 1, "not-listed",
                       formatted("[{}] is in no object list", object.second->name),
                       "add it to MandatoryObjects, OptionalObjects or ManufacturerObjects");
  }

 private:
  void check(const IniSection& section) {
    const IniKey* count = nullptr;
    const auto list = list_of(section);
    for (const auto& key : section.keys) {
      if (equals_nocase(key.key, "SupportedObjects"))
        count = &key;
      else if (const auto index = key.value.empty() ? std::nullopt : listed_index(key))
        take(key, *index, list);
    }
    check_count(section.keys.size(), count);
  }

  void take(const IniKey& key, std::uint64_t index, std::string_view list) {
    const auto* before = std::exchange(listed_[index], &key);
    if (before != nullptr && present_->has(index) && !findings_->enough_of("listed-twice"))
      findings_->warn(key, "listed-twice",
                      formatted("0x{:04X} is listed again, first in line {}", index, before->line),
                      "remove one of them");
    const auto right = right_list(index);
    const bool wrong = right.empty() ? list == kLists[2] && index >= 0x1000 : list != right;
    if (wrong && !findings_->enough_of("wrong-list"))
      findings_->warn(
          key, "wrong-list",
          formatted("0x{:04X} is in {} but belongs in {}", index, list, right.empty() ? kLists[1] : right),
          "move it to the right list");
  }

  /// The index that a line of a list means, when there is such an object.
  std::optional<std::uint64_t> listed_index(const IniKey& key) {
    const auto index = eds_number(key, 0xFFFF, *findings_);
    if (!index || present_->has(*index)) return index;
    const auto hex = parse_digits(key.value, 16);
    const bool meant_hex = hex && *hex <= 0xFFFF && present_->has(*hex);
    if (meant_hex)
      findings_->warn(key, "decimal-index", formatted("{} is taken as 0x{:04X}", key.value, *hex),
                      formatted("write 0x{:04X}: without 0x a number is decimal", *hex));
    else if (!findings_->enough_of("listed-but-absent"))
      findings_->error(key, "listed-but-absent", formatted("0x{:04X} is listed and has no section", *index),
                       "add the section, or take it off the list");
    return meant_hex ? hex : index;
  }

  void check_count(std::size_t keys, const IniKey* count) {
    if (count == nullptr || count->value.empty()) return;
    const auto number = eds_number(*count, 0xFFFF, *findings_);
    if (number && *number != keys - 1)
      findings_->warn(*count, "wrong-object-count",
                      formatted("SupportedObjects is {}, but {} follow", *number, keys - 1),
                      formatted("write SupportedObjects={}", keys - 1));
  }

  const PresentObjects* present_;
  Findings* findings_;
  std::unordered_map<std::uint64_t, const IniKey*> listed_;
};

}  // namespace

bool PresentObjects::has(std::uint64_t index) const {
  const auto found = std::lower_bound(sections.begin(), sections.end(), index,
                                      [](const auto& entry, std::uint64_t i) { return entry.first < i; });
  return (found != sections.end() && found->first == index) ||
         dictionary.object(static_cast<std::uint16_t>(index)) != nullptr;
}

void check_lists(std::span<const IniSection* const> lists, const PresentObjects& present,
                 Findings& findings) {
  Checker(present, findings).check(lists);
}

}  // namespace servoctl::od
