#include "drive/drive_settings.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "base/pdo_index.hpp"
#include "drive/naming.hpp"

namespace servoctl::drive {
namespace {

/// Objects of CiA 301 and CiA 402-2 that command the drive instead of setting it up: error history, store and
/// restore, program control, controlword, targets, offsets, outputs.
constexpr std::array<std::uint16_t, 16> kProcess{0x1003, 0x1010, 0x1011, 0x1F51, 0x6040, 0x6042,
                                                 0x6060, 0x6071, 0x607A, 0x60B0, 0x60B1, 0x60B2,
                                                 0x60C1, 0x60FE, 0x60FF, 0x1F50};

std::string_view reason(const od::Entry& entry, const od::Parameter* parameter) {
  if (entry.access == od::Access::wo) return "write-only";
  if (entry.command || (parameter != nullptr && parameter->command)) return "command";
  if (entry.is_volatile || (parameter != nullptr && parameter->is_volatile)) return "volatile";
  if (std::find(kProcess.begin(), kProcess.end(), entry.address.index) != kProcess.end())
    return "process data";
  if (entry.type == od::DataType::domain) return "domain";
  return {};
}

}  // namespace

bool is_access_unknown(const Profile& profile, const od::Entry& entry) {
  if (!profile.unknown_access.contains(entry.address) || entry.access != od::Access::ro) return false;
  const auto* parameter = profile.made_of_dictionary ? nullptr : profile.parameter(entry.address);
  return parameter == nullptr || od::writable(parameter->access);
}

std::vector<std::pair<ObjectAddress, std::string_view>> means_of_writing(const Profile& profile) {
  std::vector<std::pair<ObjectAddress, std::string_view>> out;
  const auto add = [&](const std::string& name, std::string_view reason) {
    if (name.empty()) return;
    if (const auto target = resolve(&profile, name)) out.emplace_back(target->address, reason);
  };
  add(profile.rules.store.flash_switch, "memory switch");
  if (profile.rules.store.unlock_open) add(profile.rules.store.unlock, "password");
  return out;
}

std::vector<DriveSetting> settings_of(const Profile& profile) {
  const auto means = means_of_writing(profile);
  std::vector<DriveSetting> out;
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries) {
      const bool is_writable = od::writable(entry.access);
      if (!is_writable && !is_access_unknown(profile, entry)) continue;
      const auto* parameter = profile.parameter(entry.address);
      const auto mean = std::find_if(means.begin(), means.end(),
                                     [&](const auto& each) { return each.first == entry.address; });
      out.push_back(
          {&entry, parameter, mean != means.end() ? mean->second : reason(entry, parameter), is_writable});
    }
  return out;
}

bool is_of_pdos(const Profile& profile, ObjectAddress object) {
  const auto* parameter = profile.parameter(object);
  if (parameter != nullptr && parameter->mirror && pdo_at(parameter->mirror->index)) return true;
  const auto assigns = [&](const std::string& name) {
    const auto place = place_of(profile, name);
    return place && place->index == object.index;
  };
  return pdo_at(object.index) || assigns(profile.rules.pdo.assign_rpdo) ||
         assigns(profile.rules.pdo.assign_tpdo);
}

}  // namespace servoctl::drive
