#include "settings/keeping_nodes.hpp"

#include <algorithm>

#include "drive/standard_objects.hpp"
#include "settings/register_writes.hpp"

namespace servoctl::settings {
namespace {

/// Manufacturer-specific profile area (CiA 301, 7.4.1).
constexpr std::uint16_t kFirstOfVendor = 0x2000;
constexpr std::uint16_t kLastOfVendor = 0x5FFF;

}  // namespace

KeepingNodes::KeepingNodes(show::Desk& desk, std::span<const Change> changes)
    : desk_(&desk), changes_(changes) {
  for (const auto& change : changes)
    if (nodes_.find(change.node) == nodes_.end())
      nodes_.emplace(change.node,
                     std::make_unique<session::StorageScope>(*desk.session, desk.profile, change.node));
}

void KeepingNodes::rehearse(session::Rehearsal& rehearsal) {
  for (auto& each : nodes_) each.second->rehearse(rehearsal);
}

Result<void> KeepingNodes::open(const WriteOptions& options) {
  if (const auto reachable = check_registers(*desk_, changes_); !reachable) return reachable;
  for (auto& each : nodes_) {
    const auto node = each.first;
    if (!options.keep && is_unchanged(node)) continue;
    const bool choose = std::any_of(changes_.begin(), changes_.end(), [&](const Change& change) {
      return change.node == node && goes_to_memory(change);
    });
    const auto opened = each.second->open(options.keep, options.unlock, choose);
    if (opened) continue;
    for (auto& [number, storage] : nodes_) close_node(number, *storage, false, 0);
    return opened;
  }
  return {};
}

void KeepingNodes::close(std::span<const Result<session::Written>> written) {
  for (auto& [node, storage] : nodes_) {
    std::size_t of_node = 0;
    std::size_t done = 0;
    std::size_t writes = 0;
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      if (changes_[i].node != node) continue;
      ++of_node;
      done += written[i] ? 1U : 0U;
      writes += written[i] && !changes_[i].unchanged ? 1U : 0U;
    }
    close_node(node, *storage, done == of_node, writes);
  }
}

void KeepingNodes::close_node(std::uint8_t node, session::StorageScope& storage, bool all_written,
                              std::size_t writes) {
  const auto kept = storage.close(all_written, writes);
  if (!kept) desk_->errors.push_back(kept.error());
  kept_[node] = kept.value_or(session::Kept::unknown);
  for (const auto& notice : storage.notices()) desk_->notices.push_back(notice);
}

report::Value KeepingNodes::kept(const Change& change) const {
  const auto kept = kept_.at(change.node);
  const auto index = change.target.address.index;
  const auto* profile = desk_->profile;
  if (change.target.address == objects::kControlword) return false;
  // It may have been kept before.
  if (change.unchanged && kept != session::Kept::yes) return {};
  // A switch of the memory is for the objects that go through it, and stated for the maker's own.
  const bool switched = profile != nullptr && !profile->rules.store.flash_switch.empty();
  if (switched && (!goes_to_memory(change) || !session::is_known_to_keep(*profile, change.target.address)))
    return {};
  if (kept != session::Kept::unknown) return kept == session::Kept::yes;
  // CiA 301, 7.5.2.13: what is not stored by 1010h is lost. Manuals leave open whether that holds for panel
  // parameters.
  const bool of_standard = index < kFirstOfVendor || index > kLastOfVendor;
  const bool stores = profile != nullptr && profile->rules.store.objects &&
                      profile->dictionary.find({objects::kStoreIndex, 1}) != nullptr;
  return of_standard && stores ? report::Value(false) : report::Value();
}

/// Whether nothing is written to the node.
bool KeepingNodes::is_unchanged(std::uint8_t node) const {
  return std::all_of(changes_.begin(), changes_.end(),
                     [&](const Change& change) { return change.node != node || change.unchanged; });
}

report::Value kept_text(const report::Value& kept) {
  const auto* known = std::get_if<bool>(&kept.data());
  return known == nullptr ? "not stated" : *known ? "yes" : "no";
}

/// Not the controlword, not communication objects, and not the switch that chooses the memory.
bool KeepingNodes::goes_to_memory(const Change& change) const {
  const auto object = change.target.address;
  if (object.index < 0x2000 || object.index == 0x6040 || desk_->profile == nullptr) return false;
  const auto& name = desk_->profile->rules.store.flash_switch;
  const auto flash = name.empty() ? Result<drive::Target>{} : drive::resolve(desk_->profile, name);
  return !name.empty() && flash && flash->address != object;
}

}  // namespace servoctl::settings
