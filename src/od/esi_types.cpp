#include "od/esi_types.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "od/eds_value.hpp"
#include "od/esi_value.hpp"

namespace servoctl::od {
namespace {

constexpr std::uint64_t kLastSub = 0xFF;
constexpr int kMostAliases = 8;
constexpr std::size_t kMostLabels = 512;
constexpr std::size_t kMostMembers =
    512;  ///< Beyond what sub-indices there are; those that are double are told.

/// The texts of an enumeration, in the languages the file has.
std::vector<EnumLabel> labels_of(XmlElement data_type) {
  std::vector<EnumLabel> out;
  for (const auto& info : data_type.children("EnumInfo")) {
    const auto value = esi_signed(info.child("Enum").text());
    auto text = esi_text(info, "Text");
    if (!value || text.english.empty()) continue;
    if (out.size() == kMostLabels) break;
    // A language may have an EnumInfo of its own.
    const auto known =
        std::find_if(out.begin(), out.end(), [&](const EnumLabel& label) { return label.value == *value; });
    if (known == out.end())
      out.push_back({*value, std::move(text.english), std::move(text.chinese)});
    else if (known->label_zh.empty())
      known->label_zh = std::move(text.chinese);
  }
  return out;
}

}  // namespace

EsiTypes::EsiTypes(XmlElement data_types, EsiFindings& findings) {
  for (const auto& type : data_types.children("DataType")) {
    const auto name = type.child("Name").text();
    if (name.empty())
      findings.warn(type, "missing-name", "the type has no Name; nothing can use it", "add Name");
    else if (!by_name_.emplace(name, type).second && !findings.enough_of("duplicate-type"))
      findings.warn(type, "duplicate-type",
                    formatted("{} appears again, first in line {}; the first one is used", shown(name),
                              by_name_.at(name).place().line),
                    "remove one of them");
  }
}

XmlElement EsiTypes::find(std::string_view name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? XmlElement() : found->second;
}

const EsiTypes::Known& EsiTypes::know(std::string_view name) const {
  const auto found = known_.find(name);
  if (found != known_.end()) return found->second;
  Known out;
  out.plain = find_plain(name, 0);
  if (const auto own = find(name); own.child("SubItem") || own.child("ArrayInfo")) out.composite = own;
  return known_.emplace(std::string(name), std::move(out)).first->second;
}

std::optional<EsiType> EsiTypes::plain(std::string_view name) const { return know(name).plain; }
XmlElement EsiTypes::composite(std::string_view name) const { return know(name).composite; }

std::optional<EsiType> EsiTypes::find_plain(std::string_view name, int depth) const {
  auto base = esi_base_type(name);
  const auto own = find(name);
  if (!own || depth > kMostAliases) return base;
  const auto base_name = own.child("BaseType").text();
  const bool composite = own.child("SubItem") || (own.child("ArrayInfo") && !base_name.empty());
  if (composite) return base;
  if (!base && !base_name.empty() && base_name != name) base = find_plain(base_name, depth + 1);
  if (!base) return base;
  auto labels = labels_of(own);
  if (!labels.empty()) base->labels = std::move(labels);
  return base;
}

std::optional<EsiType> EsiTypes::demand(std::string_view name, XmlElement at, EsiFindings& findings) const {
  auto type = plain(name);
  if (type) return type;
  if (name.empty())
    findings.error(at, "missing-data-type", "there is no Type", "add Type, for example UDINT");
  else
    findings.error(at, "unknown-data-type",
                   formatted("the type '{}' is not defined; its object is left out", shown(name)),
                   "define it in DataTypes, or use a base type such as UDINT");
  return std::nullopt;
}

EsiTypes::Elements EsiTypes::elements_of(XmlElement data_type, EsiFindings& findings) const {
  const auto info = data_type.child("ArrayInfo");
  Elements out;
  out.base = std::string(data_type.child("BaseType").text());
  out.first = esi_number(info.child("LBound"), kLastSub, findings, 1);
  out.count = esi_number(info.child("Elements"), 0xFFFF, findings);
  return out;
}

void EsiTypes::add_item(XmlElement item, std::vector<EsiMember>& out, EsiFindings& findings) const {
  const auto type = std::string(item.child("Type").text());
  auto display = esi_text(item, "DisplayName");
  auto name = esi_text(item, "Name");
  EsiMember member;
  member.name = display.english.empty() ? std::move(name.english) : std::move(display.english);
  member.name_zh = display.chinese.empty() ? std::move(name.chinese) : std::move(display.chinese);
  member.type = type;
  member.element = item;
  const auto index = item.child("SubIdx");
  const std::uint64_t next = out.empty() ? 0 : out.back().sub + std::uint64_t{1};
  const auto& named = know(type);
  const bool is_array =
      !named.plain && named.composite.child("ArrayInfo") && !named.composite.child("SubItem");
  const auto array = is_array ? std::optional(elements_of(named.composite, findings)) : std::nullopt;
  const auto first = index ? esi_number(index, kLastSub, findings, next) : array ? array->first : next;
  const auto count = array ? array->count : 1;
  if (count == 0 || first + count - 1 > kLastSub) {
    findings.error(item, "sub-index-range",
                   formatted("{}: {} entries from sub-index {} on; an object has 0 to 255",
                             shown(member.name), count, first),
                   "correct SubIdx, LBound or Elements");
    return;
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    member.sub = static_cast<std::uint8_t>(first + i);
    member.of_array = array.has_value();
    if (array) member.type = array->base;
    out.push_back(member);
  }
}

std::vector<EsiMember> EsiTypes::find_members(XmlElement composite, EsiFindings& findings) const {
  std::vector<EsiMember> out;
  for (const auto& item : composite.children("SubItem", kMostMembers))
    if (out.size() < kMostMembers) add_item(item, out, findings);
  if (!out.empty() || composite.child("SubItem")) return out;
  const auto elements = elements_of(composite, findings);
  for (std::uint64_t i = 0; i < elements.count && elements.first + i <= kLastSub; ++i) {
    EsiMember member;
    member.sub = static_cast<std::uint8_t>(elements.first + i);
    member.type = elements.base;
    member.element = composite;
    member.of_array = true;
    out.push_back(std::move(member));
  }
  return out;
}

const std::vector<EsiMember>& EsiTypes::members(std::string_view name, EsiFindings& findings) {
  (void)know(name);
  auto& known = known_.find(name)->second;
  if (known.members) return *known.members;
  known.members = find_members(known.composite, findings);
  std::erase_if(*known.members,
                [&](const EsiMember& member) { return !demand(member.type, member.element, findings); });
  if (known.members->size() > members_left_) {
    findings.error(known.composite, "too-many-entries",
                   "more entries than any device has; the rest is left out",
                   "the number of Elements is too high");
    known.members->resize(members_left_);
  }
  members_left_ -= known.members->size();
  return *known.members;
}

}  // namespace servoctl::od
