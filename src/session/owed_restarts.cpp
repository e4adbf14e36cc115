#include "session/owed_restarts.hpp"

#include <algorithm>
#include <utility>

#include "drive/naming.hpp"

namespace servoctl::session {

bool OwedRestarts::waits(const Node& node, ObjectAddress object) {
  if (node.profile == nullptr || object == node.node_id || object == node.bitrate) return false;
  const auto target = drive::target_at(node.profile, object);
  const auto effect = target.parameter != nullptr ? target.parameter->effect
                      : target.entry != nullptr   ? target.entry->effect
                                                  : od::Effect::unstated;
  return effect == od::Effect::restart;
}

/// Behind a restart the drive goes by what it has stored.
void OwedRestarts::settle(Node& node, std::uint32_t restarts) {
  if (restarts == node.restarts) return;
  node.restarts = restarts;
  node.changed = node.changed || !node.values.empty();
  node.values.clear();
  node.seen.clear();
  node.kept_of.reset();
}

void OwedRestarts::take(Node& node, ObjectAddress object, const Bytes& now, bool written) {
  const auto owed = std::ranges::find(node.values, object, &OwedValue::object);
  if (owed != node.values.end()) {
    if (owed->stored == now) return;
    node.changed = true;
    owed->stored = now;
    owed->earlier = false;
    if (owed->in_force != now) return;
    node.seen[object] = now;
    node.values.erase(owed);
    return;
  }
  const auto seen = node.seen.find(object);
  const bool is_known = seen != node.seen.end();
  if (!is_known && !written) {
    node.seen.emplace(object, now);
    return;
  }
  if (is_known && seen->second == now) return;
  node.changed = true;
  node.values.push_back({object, is_known ? std::optional(seen->second) : std::nullopt, now});
}

void OwedRestarts::learn(std::uint8_t node, const drive::Profile& profile) {
  auto& known = nodes_[node & 0x7FU];
  if (known.profile == &profile) return;
  known.profile = &profile;
  known.node_id = drive::place_of(profile, profile.rules.nmt.node_id);
  known.bitrate = drive::place_of(profile, profile.rules.nmt.bitrate);
}

void OwedRestarts::on_exchange(const Exchange& exchange, std::uint32_t restarts) {
  auto& node = nodes_[exchange.node & 0x7FU];
  if (!exchange.result || !waits(node, exchange.object)) return;
  settle(node, restarts);
  const bool written = exchange.written != nullptr;
  take(node, exchange.object, written ? *exchange.written : *exchange.result, written);
}

void OwedRestarts::take_up(std::uint8_t node, std::vector<OwedValue> values, Identity of) {
  auto& known = nodes_[node & 0x7FU];
  for (auto& value : values) value.earlier = true;
  known.values = std::move(values);
  known.kept_of = std::move(of);
}

void OwedRestarts::forget(std::uint8_t node) {
  auto& known = nodes_[node & 0x7FU];
  known.values.clear();
  known.seen.clear();
  known.kept_of.reset();
}

void OwedRestarts::settle_identity(std::uint8_t node, bool same) {
  auto& known = nodes_[node & 0x7FU];
  known.kept_of.reset();
  if (same) return;
  std::erase_if(known.values, &OwedValue::earlier);
  // What the other drive went by.
  for (auto& value : known.values) value.in_force.reset();
  known.changed = true;
}

const std::vector<OwedValue>& OwedRestarts::values(std::uint8_t node, std::uint32_t restarts) {
  auto& known = nodes_[node & 0x7FU];
  settle(known, restarts);
  return known.values;
}

}  // namespace servoctl::session
