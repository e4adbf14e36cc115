#include "od/eds_keys.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "base/format.hpp"
#include "base/text.hpp"
#include "od/eds_section.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

/// CiA 306-1, 4.6 and 5.3.
constexpr auto kOfObjects = std::to_array<std::string_view>(
    {"ParameterName", "ObjectType", "DataType", "AccessType", "DefaultValue", "LowLimit", "HighLimit",
     "PDOMapping", "SubNumber", "CompactSubObj", "ObjFlags", "ParameterValue", "Denotation", "UploadFile",
     "DownloadFile"});
/// CiA 306-1, 4.5.3 and 5.2.
constexpr auto kOfDevices = std::to_array<std::string_view>(
    {"VendorName", "VendorNumber", "ProductName", "ProductNumber", "ProductVersion", "RevisionNumber",
     "OrderCode", "Granularity", "CompactPDO", "NrOfRXPDO", "NrOfTXPDO", "SimpleBootUpMaster",
     "SimpleBootUpSlave", "DynamicChannelsSupported", "GroupMessaging", "LSS_Supported"});
constexpr auto kOfCommissioning = std::to_array<std::string_view>(
    {"NodeID", "NodeName", "Baudrate", "NetNumber", "NetworkName", "CANopenManager", "LSS_SerialNumber"});

std::span<const std::string_view> known_keys(std::string_view section) {
  auto name = parse_section_name(section);
  if (!name)
    if (const auto meant = respelt_section_name(section)) name = parse_section_name(*meant);
  if (!name) return {};
  switch (name->kind) {
    case SectionKind::object:
    case SectionKind::sub: return kOfObjects;
    case SectionKind::device_info: return kOfDevices;
    case SectionKind::commissioning: return kOfCommissioning;
    default: return {};
  }
}

bool is_known(std::string_view key, std::span<const std::string_view> known) {
  return std::any_of(known.begin(), known.end(),
                     [&](std::string_view name) { return equals_nocase(name, key); });
}

/// The key that is meant: two letters may be wrong in a long one. What only has a digit more is another key
/// of the vendor's.
std::string_view meant_key(std::string_view key, std::span<const std::string_view> known) {
  constexpr std::size_t kShortest = 6;
  constexpr std::size_t kLongest = 30;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (key.size() < kShortest || key.size() > kLongest || std::any_of(key.begin(), key.end(), is_digit))
    return {};
  if (is_known(key, known)) return {};
  for (const auto name : known)
    if (edit_distance(key, name) <= (name.size() < 8 ? 1U : 2U)) return name;
  return {};
}

/// What a section holds is asked for only where a key is strange: most files have none.
bool has_strange_key(const IniSection& section) {
  return std::any_of(section.keys.begin(), section.keys.end(),
                     [](const IniKey& key) { return !is_known(key.key, kOfObjects); });
}

void tell(const IniSection& section, const IniKey& key, std::string_view meant, bool both,
          Findings& findings) {
  if (findings.enough_of("misspelt-key")) return;
  const auto what = formatted("[{}] {}", shown(section.name), shown(key.key));
  findings.warn(key, "misspelt-key",
                both ? formatted("{} is ignored: {} is also present", what, meant)
                     : formatted("{} is taken as {}", what, meant),
                both ? std::string("remove one of them") : formatted("write {}", meant));
}

void mend(IniText& ini, Findings* findings) {
  constexpr std::size_t kMostKeys = 64;  // Above any object: each may be looked for in its section.
  auto* keys = ini.keys.data();
  std::size_t at = 0;
  for (const auto& section : ini.sections) {
    const auto first = at;
    at += section.keys.size();
    if (section.keys.size() > kMostKeys || !has_strange_key(section)) continue;
    const auto known = known_keys(section.name);
    for (auto i = first; i < at && !known.empty(); ++i) {
      auto& key = keys[i];
      const auto meant = meant_key(key.key, known);
      if (meant.empty()) continue;
      // A second ParameterValue is refused where it would be written: it must not be passed over.
      const bool both = meant != "ParameterValue" && section.find(meant) != nullptr;
      if (findings != nullptr) tell(section, key, meant, both, *findings);
      if (!both) key.key = meant;
    }
  }
}

}  // namespace

void mend_keys(IniText& ini, Findings& findings) { mend(ini, &findings); }
void mend_keys(IniText& ini) { mend(ini, nullptr); }

}  // namespace servoctl::od
