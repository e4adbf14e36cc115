#include "show/standard_names.hpp"

#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::show {
namespace {

constexpr std::uint16_t kCommunicationFirst = 0x1000;
constexpr std::uint16_t kCommunicationLast = 0x1FFF;
constexpr std::uint16_t kProfileFirst = 0x6000;

}  // namespace

drive::Target StandardNames::at(std::uint8_t node, ObjectAddress address) {
  if (desk_->profile != nullptr || desk_->standard == nullptr)
    return drive::target_at(desk_->profile, address);
  const bool of_301 = address.index >= kCommunicationFirst && address.index <= kCommunicationLast;
  const bool known = of_301 || (address.index >= kProfileFirst && is_drive(node));
  return drive::target_at(known ? desk_->standard : nullptr, address);
}

drive::Target StandardNames::named(std::uint8_t node, const drive::Target& target) {
  return target.entry == nullptr && target.parameter == nullptr && target.unlisted.empty()
             ? at(node, target.address)
             : target;
}

bool StandardNames::is_drive(std::uint8_t node) {
  const auto known = drives_.find(node);
  if (known != drives_.end()) return known->second;
  auto& session = *desk_->session;
  auto type = session.device_type(node);
  if (const auto* identity = session.identities().find(node, session.watch().boots(node));
      !type && identity != nullptr)
    type = identity->device_type;
  if (!type && session.modbus() == nullptr)
    if (const auto read = session.upload(node, objects::kDeviceType); read)
      type = static_cast<std::uint32_t>(load_le(*read));
  const bool out = type && drive::is_drive_type(*type);
  drives_.emplace(node, out);
  return out;
}

}  // namespace servoctl::show
