// What a drive model keeps when its power goes, and what it makes of that when it starts.
#include <algorithm>

#include "canopen/node_id.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "sim/drive_model.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;

namespace {

/// Whether sub-index 1..4 of 1010h and 1011h speaks of an object: all, communication, application (the device
/// profile), manufacturer (CiA 301, 7.5.2.13).
bool is_in(std::uint8_t group, std::uint16_t index) {
  switch (group) {
    case 2: return index < 0x2000;
    case 3: return index >= 0x6000;
    case 4: return index >= 0x2000 && index < 0x6000;
    default: return true;
  }
}

/// Where what LSS stores is kept, beside the drive's own objects.
constexpr const char* kLssMemory = ".lss";
constexpr ObjectAddress kLssNode{0, 1};

}  // namespace

void DriveModel::restore_if_asked() {
  auto& cells = memory_->cells(key_);
  const auto set = [&](const std::string& id) {
    const auto* p = parameter(id);
    const auto cell = p != nullptr && p->object ? cells.find(*p->object) : cells.end();
    return cell != cells.end() && load_le(cell->second) == 1;
  };
  if (set(profile_->rules.store.restore_at_start)) cells.clear();
  if (set(profile_->rules.store.clear_alarms_at_start))
    cells.erase(*parameter(profile_->rules.store.clear_alarms_at_start)->object);
  (void)memory_->save();
}

/// A drive that is made without a node-ID gets none from its family's default either.
void DriveModel::begin_memory(std::uint8_t node) {
  auto& cells = memory_->cells(key_);
  const auto node_id = drive::place_of(*profile_, profile_->rules.nmt.node_id);
  const auto* entry = node_id ? profile_->dictionary.find(*node_id) : nullptr;
  if (entry != nullptr && cells.find(*node_id) != cells.end()) return;
  if (node == canopen::kUnconfigured)
    memory_->cells(key_ + kLssMemory).try_emplace(kLssNode, Bytes{node});
  else if (entry != nullptr && (!entry->default_value || od::to_double(entry->default_value->value) != node))
    cells[*node_id] = store_le(node, od::size_of(entry->type).value_or(1));
}

/// What LSS has stored, where the family has no parameter of the node-ID or there is to be none; else that
/// parameter.
std::optional<std::uint8_t> DriveModel::kept_node() const {
  const auto& own = memory_->cells(key_ + kLssMemory);
  if (const auto found = own.find(kLssNode); found != own.end())
    return static_cast<std::uint8_t>(load_le(found->second));
  const auto node_id = drive::place_of(*profile_, profile_->rules.nmt.node_id);
  const auto set_to = node_id ? values_.number(*node_id) : 0;
  if (set_to < canopen::kFirstNode || set_to > canopen::kLastNode) return std::nullopt;
  return static_cast<std::uint8_t>(set_to);
}

bool DriveModel::store_node(std::uint8_t node) {
  auto& own = memory_->cells(key_ + kLssMemory);
  const auto node_id = drive::place_of(*profile_, profile_->rules.nmt.node_id);
  const auto* entry = node_id ? profile_->dictionary.find(*node_id) : nullptr;
  if (entry == nullptr || node == canopen::kUnconfigured) {
    own[kLssNode] = {node};
  } else {
    own.erase(kLssNode);
    memory_->cells(key_)[*node_id] = store_le(node, od::size_of(entry->type).value_or(1));
  }
  return memory_->save().has_value();
}

void DriveModel::load_mirrors() {
  const auto& with_node = profile_->rules.mirror_add_node_id;
  for (const auto& p : profile_->parameters) {
    if (!p.mirror || !p.object || !values_.has(*p.mirror)) continue;
    const bool add = std::find(with_node.begin(), with_node.end(), *p.mirror) != with_node.end();
    values_.set_number(*p.mirror, effective(*p.object) + (add ? node_ : 0U));
  }
}

std::uint32_t DriveModel::restore_objects(std::uint8_t group) {
  std::erase_if(memory_->cells(key_), [&](const auto& cell) { return is_in(group, cell.first.index); });
  return memory_->save() ? 0 : abort::kCannotStore;
}

std::uint32_t DriveModel::save_objects(std::uint8_t group) {
  auto& cells = memory_->cells(key_);
  for (const auto& object : profile_->dictionary.objects())
    for (const auto& entry : object.entries)
      if (is_in(group, object.index) && entry.access == od::Access::rw && !entry.command &&
          !entry.is_volatile && entry.address != objects::kControlword)
        cells[entry.address] = values_.get(entry.address);
  return memory_->save() ? 0 : abort::kCannotStore;
}

}  // namespace servoctl::sim
