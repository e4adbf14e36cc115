#include "base/pdo_index.hpp"

namespace servoctl {
namespace {

constexpr std::uint16_t kFirstReceive = 0x1400;
constexpr std::uint16_t kFirstTransmit = 0x1800;
constexpr std::uint16_t kMappingOffset = 0x200;

}  // namespace

std::optional<PdoPlace> pdo_at(std::uint16_t index) {
  if (index < kFirstReceive || index >= kFirstTransmit + 2 * kMappingOffset) return std::nullopt;
  const auto offset = static_cast<std::uint16_t>(index - kFirstReceive);
  return PdoPlace{index < kFirstTransmit ? PdoDirection::receive : PdoDirection::transmit,
                  static_cast<std::uint16_t>(offset % kMappingOffset + 1), offset / kMappingOffset % 2 == 1};
}

bool is_pdo_communication(std::uint16_t index) {
  const auto place = pdo_at(index);
  return place && !place->mapping;
}

bool is_pdo_mapping(std::uint16_t index) {
  const auto place = pdo_at(index);
  return place && place->mapping;
}

std::uint16_t index_of(const PdoPlace& place) {
  const auto first = place.direction == PdoDirection::receive ? kFirstReceive : kFirstTransmit;
  return static_cast<std::uint16_t>(first + (place.mapping ? kMappingOffset : 0) + place.number - 1);
}

}  // namespace servoctl
