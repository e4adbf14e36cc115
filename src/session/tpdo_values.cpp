#include "session/tpdo_values.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::session {

TpdoValues::TpdoValues(CanNetwork& network, std::uint8_t node, std::span<const canopen::Pdo> pdos,
                       std::span<const ObjectAddress> objects)
    : network_(&network),
      node_(node),
      epoch_(network.epoch(node)),
      hearing_(&network, [this](const can::Frame& frame, TimePoint time) { on_frame(frame, time); }) {
  for (const auto object : objects) values_[object];
  for (const auto& pdo : pdos) {
    const bool carries = std::any_of(pdo.entries.begin(), pdo.entries.end(), [&](const auto& entry) {
      return !entry.is_gap() && values_.count(entry.object) != 0;
    });
    if (pdo.direction == canopen::PdoDirection::transmit && pdo.is_valid() && carries) pdos_.push_back(pdo);
  }
}

std::optional<Bytes> TpdoValues::take(ObjectAddress object, TimePoint since) {
  if (!holds()) return std::nullopt;
  const auto known = values_.find(object);
  if (known == values_.end() || !known->second || known->second->time < since) return std::nullopt;
  return std::exchange(known->second, std::nullopt)->bytes;
}

bool TpdoValues::carries(ObjectAddress object) const {
  return holds() && std::any_of(pdos_.begin(), pdos_.end(), [&](const canopen::Pdo& pdo) {
           return std::any_of(pdo.entries.begin(), pdo.entries.end(),
                              [&](const auto& entry) { return entry.object == object; });
         });
}

void TpdoValues::on_frame(const can::Frame& frame, TimePoint time) {
  if (frame.remote || frame.error) return;
  for (const auto& pdo : pdos_) {
    const bool extended = (pdo.cob_id & canopen::kPdoExtended) != 0;
    if (frame.id != (pdo.cob_id & canopen::kPdoCobIdMask) || frame.extended != extended) continue;
    // Another length is another mapping than the one that was read.
    if (frame.size != (pdo.bits() + 7) / 8 || !holds()) continue;
    auto parts = canopen::unpack_pdo(pdo.entries, frame.payload());
    for (std::size_t i = 0; parts && i < parts->size(); ++i) {
      const auto place = values_.find(pdo.entries[i].object);
      if (place == values_.end()) continue;
      if (keeps_all_) arrivals_.push_back({place->first, (*parts)[i], time});
      if (pdo.entries[i].bits % 8 == 0) place->second = Value{std::move((*parts)[i]), time};
    }
  }
}

}  // namespace servoctl::session
