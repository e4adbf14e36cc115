#include "drive/file_identity.hpp"

#include <variant>

#include "base/text.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::drive {
namespace {

/// The default of an entry that nobody can write; null where there is none.
const od::Value* constant(const od::EdsFile& file, ObjectAddress object) {
  const auto* entry = file.dictionary.find(object);
  if (entry == nullptr || od::writable(entry->access) || !entry->default_value ||
      entry->default_value->plus_node_id)
    return nullptr;
  return &entry->default_value->value;
}

std::uint64_t number(const od::EdsFile& file, ObjectAddress object) {
  const auto* value = constant(file, object);
  if (value == nullptr) return 0;
  if (const auto* whole = std::get_if<std::uint64_t>(value)) return *whole;
  if (const auto* whole = std::get_if<std::int64_t>(value)) return static_cast<std::uint32_t>(*whole);
  return 0;
}

/// What a master knows an EtherCAT device by; defaults of objects in its file are often those of another.
std::vector<IdentityMark> ethercat_marks(const od::DeviceInfo& device) {
  std::vector<IdentityMark> out;
  const auto take = [&](ObjectAddress object, std::uint32_t value, bool soft) {
    if (value != 0) out.push_back({.object = object, .value = value, .text = {}, .soft = soft});
  };
  take(objects::kVendorId, device.vendor_number, false);
  take(objects::kProductCode, device.product_number, false);
  take(objects::kRevision, device.revision_number, true);
  return out;
}

}  // namespace

std::vector<IdentityMark> identity_marks(const od::EdsFile& file) {
  std::vector<IdentityMark> out;
  if (file.ethercat) return ethercat_marks(file.device);
  if (const auto type = number(file, objects::kDeviceType); type != 0)
    out.push_back({.object = objects::kDeviceType, .value = type, .text = {}});
  const auto take = [&](ObjectAddress object, std::uint32_t info, bool soft) {
    const auto fixed = number(file, object);
    const auto value = fixed == 0 ? info : fixed;
    if (value == 0 || (info != 0 && info != value)) return;
    out.push_back({.object = object, .value = value, .text = {}, .soft = soft});
  };
  take(objects::kVendorId, file.device.vendor_number, false);
  take(objects::kProductCode, file.device.product_number, false);
  take(objects::kRevision, file.device.revision_number, true);
  if (const auto* name = constant(file, objects::kDeviceName))
    if (const auto* text = std::get_if<std::string>(name); text != nullptr)
      if (const auto trimmed = trim(*text); !trimmed.empty() && trimmed != "0")
        out.push_back({.object = objects::kDeviceName, .text = std::string(trimmed)});
  return out;
}

}  // namespace servoctl::drive
