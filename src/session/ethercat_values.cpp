#include "session/ethercat_values.hpp"

#include <utility>

namespace servoctl::session {

std::optional<Bytes> EtherCatValues::take(ObjectAddress object, TimePoint since) {
  if (!node_->exchanges()) return std::nullopt;
  const auto bits = node_->image->input_bits(node_->number, object);
  if (!bits || *bits % 8 != 0) return std::nullopt;
  auto input = node_->image->input(node_->number, object);
  if (!input || input->time < since) return std::nullopt;
  auto& taken = taken_[object];
  if (input->time <= taken) return std::nullopt;
  taken = input->time;
  return std::move(input->value);
}

}  // namespace servoctl::session
