#include "session/owed_restarts.hpp"

#include <algorithm>
#include <utility>

#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {

namespace {

/// Objects of the vendor (CiA 301, 7.4.1).
constexpr std::uint16_t kFirstOfVendor = 0x2000;
constexpr std::uint16_t kLastOfVendor = 0x5FFF;

}  // namespace

od::Effect OwedRestarts::effect_of(const Node& node, ObjectAddress object) {
  if (node.profile == nullptr) return od::Effect::unstated;
  const auto target = drive::target_at(node.profile, object);
  if (target.parameter != nullptr) return target.parameter->effect;
  return target.entry != nullptr ? target.entry->effect : od::Effect::unstated;
}

/// The data of a family say which objects wait: the others do not. The standard, and a file without a family,
/// say nothing of those that they do not describe.
bool OwedRestarts::is_judged(const Node& node, ObjectAddress object) {
  if (node.profile == nullptr) return false;
  return !node.profile->is_generic() || effect_of(node, object) != od::Effect::unstated;
}

bool OwedRestarts::waits(const Node& node, ObjectAddress object) {
  if (node.profile == nullptr) return false;
  const auto effect = effect_of(node, object);
  // No drive changes its own address or bitrate while it answers, unless its data say so.
  if (object == node.node_id || object == node.bitrate) return effect != od::Effect::immediate;
  return effect == od::Effect::restart;
}

bool OwedRestarts::has_restarted(const Node& node, Starts before, Starts now) {
  return node.by_power ? now.power_ups != before.power_ups : now.restarts != before.restarts;
}

/// Behind a restart the drive goes by what it has stored.
void OwedRestarts::settle(Node& node, Starts starts) {
  if (!has_restarted(node, std::exchange(node.starts, starts), starts)) return;
  node.changed = node.changed || !node.values.empty();
  node.values.clear();
  node.seen.clear();
  node.kept_of.reset();
}

void OwedRestarts::take(Node& node, ObjectAddress object, const Bytes& now, bool written) {
  const auto owed = std::ranges::find(node.values, object, &OwedValue::object);
  if (owed != node.values.end()) {
    const bool kept = written ? node.to_flash : owed->kept;
    node.changed = node.changed || owed->kept != kept || owed->stored != now;
    owed->kept = kept;
    if (owed->stored == now) return;
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
  node.values.push_back({object, is_known ? std::optional(seen->second) : std::nullopt, now, node.to_flash});
}

void OwedRestarts::learn(std::uint8_t node, const drive::Profile& profile, bool registers, Starts starts) {
  auto& known = nodes_[node & 0x7FU];
  if (known.profile == &profile) return;
  known.profile = &profile;
  known.node_id =
      drive::place_of(profile, registers ? profile.rules.modbus.node_id : profile.rules.nmt.node_id);
  known.bitrate = drive::place_of(profile, profile.rules.nmt.bitrate);
  known.flash_switch = drive::place_of(profile, profile.rules.store.flash_switch);
  known.by_power = profile.rules.nmt.address_after == drive::NmtRules::Restart::power_cycle;
  for (auto& one : std::exchange(known.unjudged, {})) {
    const auto& value = one.value;
    if (!is_judged(known, value.object)) {
      known.unjudged.push_back(std::move(one));
      continue;
    }
    if (has_restarted(known, one.since, starts) || !waits(known, value.object)) continue;
    settle(known, starts);
    take(known, value.object, value.stored, true);
    const auto owed = std::ranges::find(known.values, value.object, &OwedValue::object);
    if (owed != known.values.end()) owed->kept = owed->kept || value.kept;
  }
}

/// Which restart is one of this drive, nobody knows yet: one by power is.
void OwedRestarts::forget_unjudged(Node& node, Starts starts) {
  std::erase_if(node.unjudged, [&](const Unjudged& one) { return one.since.power_ups != starts.power_ups; });
}

std::vector<ObjectAddress> OwedRestarts::take_unjudged(std::uint8_t node, Starts starts) {
  auto& known = nodes_[node & 0x7FU];
  forget_unjudged(known, starts);
  std::vector<ObjectAddress> out;
  for (auto& one : known.unjudged)
    if (!std::exchange(one.reported, true)) out.push_back(one.value.object);
  return out;
}

void OwedRestarts::note_unjudged(Node& node, const Exchange& exchange, Starts starts) {
  if (exchange.written == nullptr) return;
  if (exchange.object.index == objects::kStoreIndex)
    for (auto& one : node.unjudged) one.value.kept = true;
  if (exchange.object.index < kFirstOfVendor || exchange.object.index > kLastOfVendor) return;
  if (is_judged(node, exchange.object)) return;
  forget_unjudged(node, starts);
  std::erase_if(node.unjudged, [&](const Unjudged& one) { return one.value.object == exchange.object; });
  node.unjudged.push_back({{.object = exchange.object, .stored = *exchange.written}, starts});
}

bool OwedRestarts::awaits_bitrate(std::uint8_t node) const {
  const auto& known = nodes_[node & 0x7FU];
  return known.bitrate &&
         std::ranges::find(known.values, *known.bitrate, &OwedValue::object) != known.values.end();
}

/// The drive is told to store what it has, or where its values go from now on.
void OwedRestarts::note_storing(Node& node, const Exchange& exchange) {
  const auto& store = node.profile->rules.store;
  const auto number = load_le(exchange.written != nullptr ? *exchange.written : *exchange.result);
  if (exchange.object == node.flash_switch && store.to_flash)
    node.to_flash = number == static_cast<std::uint64_t>(*store.to_flash);
  if (exchange.written == nullptr) return;
  const bool stores = exchange.object.index == objects::kStoreIndex ||
                      std::ranges::any_of(store.store, [&](const drive::Setting& setting) {
                        return drive::place_of(*node.profile, setting.name) == exchange.object &&
                               number == static_cast<std::uint64_t>(setting.value);
                      });
  for (auto& value : node.values) {
    node.changed = node.changed || (stores && !value.kept);
    value.kept = value.kept || stores;
  }
}

void OwedRestarts::on_exchange(const Exchange& exchange, Starts starts) {
  auto& node = nodes_[exchange.node & 0x7FU];
  if (!exchange.result) return;
  note_unjudged(node, exchange, starts);
  if (node.profile == nullptr) return;
  note_storing(node, exchange);
  if (!waits(node, exchange.object)) return;
  settle(node, starts);
  const bool written = exchange.written != nullptr;
  take(node, exchange.object, written ? *exchange.written : *exchange.result, written);
}

void OwedRestarts::take_up(std::uint8_t node, std::vector<OwedValue> values, Identity of, bool by_power,
                           std::optional<ObjectAddress> node_id) {
  auto& known = nodes_[node & 0x7FU];
  for (auto& value : values) value.earlier = true;
  known.values = std::move(values);
  known.kept_of = std::move(of);
  known.by_power = by_power;
  known.node_id = node_id;
}

void OwedRestarts::add_from_others(std::uint8_t node, std::vector<OwedValue> values) {
  auto& known = nodes_[node & 0x7FU];
  for (auto& value : values)
    if (std::ranges::find(known.values, value.object, &OwedValue::object) == known.values.end())
      known.values.push_back(std::move(value));
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

const std::vector<OwedValue>& OwedRestarts::values(std::uint8_t node, Starts starts) {
  auto& known = nodes_[node & 0x7FU];
  settle(known, starts);
  return known.values;
}

}  // namespace servoctl::session
