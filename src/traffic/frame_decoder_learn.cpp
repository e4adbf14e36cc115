// What a FrameDecoder remembers of SDO transfers, for the frames that follow.
#include "drive/standard_objects.hpp"
#include "traffic/frame_decoder.hpp"

namespace servoctl::traffic {

void FrameDecoder::set_family(std::uint8_t node, const drive::Profile* profile) {
  families_[node % families_.size()] = profile;
  pdos_.set_family(node, profile);
  modes_.set_family(node, profile);
}

const drive::Profile* FrameDecoder::family_of(std::uint8_t node) const {
  const auto* own = families_[node % families_.size()];
  return own != nullptr ? own : options_.profile;
}

/// A value that was read holds; one that was written holds when the node has taken it.
void FrameDecoder::learn(const canopen::SdoStep& step) {
  auto& pending = pending_[*out_.node];
  const bool emergency = step.object == objects::kEmergencyCobId;
  if (!step.object || (!emergency && !canopen::pdo_at(step.object->index))) return;
  const auto keep = [&](const Bytes& data) {
    if (emergency && data.size() == 4)
      emergency_ids_.learn(*out_.node, static_cast<std::uint32_t>(load_le(data)));
    else if (!emergency)
      pdos_.learn(*out_.node, *step.object, data);
  };
  if (step.data && !step.from_client) keep(*step.data);
  if (step.data && step.from_client) pending = Pending{*step.object, *step.data};
  if (step.kind == canopen::SdoStep::Kind::abort) pending.reset();
  if (step.kind != canopen::SdoStep::Kind::acknowledge || !pending || pending->object != *step.object) return;
  keep(pending->data);
  pending.reset();
}

}  // namespace servoctl::traffic
