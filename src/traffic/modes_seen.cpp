#include "traffic/modes_seen.hpp"

#include "drive/standard_mode.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::traffic {

using Step = canopen::SdoStep::Kind;

std::int8_t ModesSeen::meaning_of(std::uint8_t id, std::int8_t mode) const {
  const auto own = families_.find(id);
  const auto* family = own == families_.end() ? profile_ : own->second;
  return family == nullptr ? mode : drive::standard_mode(family->rules.motion, mode);
}

void ModesSeen::ask(std::uint8_t id, Node& node, std::int8_t mode) const {
  node.asked = mode;
  node.mode = meaning_of(id, mode);
}

void ModesSeen::on_sdo(std::uint8_t id, const canopen::SdoStep& step) {
  auto& node = nodes_[id % nodes_.size()];
  const bool asked = step.object == objects::kModeOfOperation;
  if (!asked && step.object != objects::kModeDisplay) return;
  if (step.data && step.data->size() == 1) {
    const auto mode = static_cast<std::int8_t>(step.data->front());
    if (!asked && !step.from_client) node.mode = meaning_of(id, mode);
    if (asked && step.from_client) node.pending = mode;
  }
  if (step.kind == Step::abort) node.pending.reset();
  if (step.kind != Step::acknowledge || !asked || !node.pending) return;
  ask(id, node, *node.pending);
  node.pending.reset();
}

void ModesSeen::on_pdo(const show::PdoView& view, ByteSpan data) {
  const auto id = view.node;
  auto& node = nodes_[id % nodes_.size()];
  for (const auto& field : view.fields) {
    const bool asked = field.entry.object == objects::kModeOfOperation;
    if ((!asked && field.entry.object != objects::kModeDisplay) || !show::shows_values(view, data)) continue;
    const auto mode = field.mode(data);
    if (!asked)
      node.mode = meaning_of(id, mode);
    else if (node.asked != mode)
      ask(id, node, mode);
  }
}

}  // namespace servoctl::traffic
