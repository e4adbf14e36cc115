#include "traffic/modes_seen.hpp"

#include "drive/standard_mode.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::traffic {

using Step = canopen::SdoStep::Kind;

std::int8_t ModesSeen::meaning_of(std::int8_t mode) const {
  return profile_ == nullptr ? mode : drive::standard_mode(profile_->rules.motion, mode);
}

void ModesSeen::ask(Node& node, std::int8_t mode) const {
  node.asked = mode;
  node.mode = meaning_of(mode);
}

void ModesSeen::on_sdo(std::uint8_t id, const canopen::SdoStep& step) {
  auto& node = nodes_[id % nodes_.size()];
  const bool asked = step.object == objects::kModeOfOperation;
  if (!asked && step.object != objects::kModeDisplay) return;
  if (step.data && step.data->size() == 1) {
    const auto mode = static_cast<std::int8_t>(step.data->front());
    if (!asked && !step.from_client) node.mode = meaning_of(mode);
    if (asked && step.from_client) node.pending = mode;
  }
  if (step.kind == Step::abort) node.pending.reset();
  if (step.kind != Step::acknowledge || !asked || !node.pending) return;
  ask(node, *node.pending);
  node.pending.reset();
}

void ModesSeen::on_pdo(const show::PdoView& view, ByteSpan data) {
  auto& node = nodes_[view.node % nodes_.size()];
  for (const auto& field : view.fields) {
    const bool asked = field.entry.object == objects::kModeOfOperation;
    if ((!asked && field.entry.object != objects::kModeDisplay) || !show::shows_values(view, data)) continue;
    const auto mode = field.mode(data);
    if (!asked)
      node.mode = meaning_of(mode);
    else if (node.asked != mode)
      ask(node, mode);
  }
}

}  // namespace servoctl::traffic
