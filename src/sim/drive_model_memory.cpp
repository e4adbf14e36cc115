// What a drive model keeps when its power goes, and what it makes of that when it starts.
#include <algorithm>

#include "canopen/sdo_abort.hpp"
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
