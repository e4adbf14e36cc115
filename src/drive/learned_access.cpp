#include "drive/learned_access.hpp"

#include <algorithm>

#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"
#include "drive/word_bits.hpp"

namespace servoctl::drive {
namespace {

constexpr std::uint16_t kOfMakerFirst = 0x2000;
constexpr std::uint16_t kOfProfileFirst = 0x6000;

/// As the sheet was made: by the statusword of the axis; a first axis without one by 1000h.
bool is_of_drive_axis(const od::EdsFile& sheet, std::uint16_t index) {
  const auto first = of_first_axis({index, 0}).index;
  const auto further = static_cast<std::uint16_t>(index - first);
  const auto statusword = static_cast<std::uint16_t>(objects::kStatusword.index + further);
  if (sheet.dictionary.object(statusword) != nullptr) return true;
  const auto* type = sheet.dictionary.find(objects::kDeviceType);
  const bool says_type = type != nullptr && type->default_value;
  return further == 0 &&
         (!says_type || is_drive_type(static_cast<std::uint64_t>(od::to_double(type->default_value->value))));
}

}  // namespace

const od::Object* standard_object(const od::Dictionary& standard, std::uint16_t index, bool is_of_drive) {
  if (index < kOfProfileFirst) return standard.object(index);
  return is_of_drive ? standard.object(of_first_axis({index, 0}).index) : nullptr;
}

std::set<ObjectAddress> unknown_access(const od::EdsFile& sheet, const od::Dictionary& standard) {
  std::set<ObjectAddress> out;
  if (!sheet.learned) return out;
  for (const auto& object : sheet.dictionary.objects()) {
    const bool is_of_maker = object.index >= kOfMakerFirst && object.index < kOfProfileFirst;
    if (standard.empty() && !is_of_maker) continue;
    const auto* known = standard_object(standard, object.index, is_of_drive_axis(sheet, object.index));
    for (const auto& entry : object.entries) {
      const auto says_ro = [&](const od::Entry& said) {
        return said.address.sub == entry.address.sub && !od::writable(said.access);
      };
      const bool is_known =
          known != nullptr && std::any_of(known->entries.begin(), known->entries.end(), says_ro);
      if (entry.access == od::Access::ro && !is_known) out.insert(entry.address);
    }
  }
  return out;
}

}  // namespace servoctl::drive
