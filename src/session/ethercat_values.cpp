#include "session/ethercat_values.hpp"

#include <algorithm>
#include <utility>

namespace servoctl::session {

EtherCatValues::EtherCatValues(EtherCatNode& node, std::span<const ObjectAddress> objects)
    : node_(&node), objects_(objects.begin(), objects.end()) {
  std::sort(objects_.begin(), objects_.end());
  objects_.erase(std::unique(objects_.begin(), objects_.end()), objects_.end());
  node_->listeners.push_back(this);
}

EtherCatValues::~EtherCatValues() { std::erase(node_->listeners, this); }

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

bool EtherCatValues::carries(ObjectAddress object) const {
  return node_->exchanges() && node_->image->input_bits(node_->number, object).has_value();
}

void EtherCatValues::note() {
  if (!keeps_all_ || !node_->exchanges()) return;
  const auto before = noted_;
  for (const auto object : objects_) {
    auto input = node_->image->input(node_->number, object);
    if (!input || input->time <= before) continue;
    noted_ = input->time;
    arrivals_.push_back({object, std::move(input->value), input->time});
  }
}

}  // namespace servoctl::session
