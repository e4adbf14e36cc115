// What a CAN network knows of the PDOs of its nodes.
#include "session/can_network.hpp"
#include "session/tpdo_values.hpp"

namespace servoctl::session {

canopen::NodeEpoch CanNetwork::epoch(std::uint8_t node) const {
  auto out = epochs_.of(node);
  out.losses = watch_.losses(node) + guard_.losses(node);
  return out;
}

const CanNetwork::KnownPdos* CanNetwork::known_pdos(std::uint8_t node) const {
  const auto known = pdos_.find(node);
  return known == pdos_.end() || known->second.epoch != epoch(node) ? nullptr : &known->second;
}

std::unique_ptr<ProcessValues> CanNetwork::process_values(std::uint8_t node,
                                                          std::span<const ObjectAddress> objects) {
  const auto* known = known_pdos(node);
  const auto pdos = known == nullptr ? std::span<const canopen::Pdo>() : std::span(known->pdos);
  return std::make_unique<TpdoValues>(*this, node, pdos, objects);
}

}  // namespace servoctl::session
