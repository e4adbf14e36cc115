#include "session/ring_state.hpp"

#include "base/format.hpp"
#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::session {
namespace {

using ethercat::AlState;

bool serves_objects(AlState state) {
  return state == AlState::preop || state == AlState::safeop || state == AlState::op;
}

/// Of a drive that cannot be asked nothing is known, and its state may be what keeps it from answering.
Result<void> check_without_power(Session& session, std::uint8_t node) {
  const auto power = has_power(session, node);
  if (!power && (power.error().code == Errc::bus || power.error().code == Errc::interrupted ||
                 power.error().code == Errc::refused))
    return fail(power.error());
  if (!power || !*power) return {};
  return fail(drive_error(Errc::refused, node,
                          "it is energised: a change of its AL state would de-energise it in motion",
                          message("`disable -n {}` first", node_name(node))));
}

}  // namespace

Error no_slave_at(std::uint8_t node, std::size_t present) {
  return drive_error(Errc::timeout, node,
                     message("there is no slave at this position (slaves on the ring: {})", present),
                     "`scan` shows them");
}

Result<std::vector<std::uint8_t>> foreign_nodes(EtherCatNetwork& ring, std::span<const std::uint8_t> nodes) {
  const auto seen = ring.look(false);
  if (!seen) return fail(seen.error());
  std::vector<std::uint8_t> out;
  for (const auto node : nodes) {
    if (node > seen->size()) return fail(no_slave_at(node, seen->size()));
    if ((*seen)[node - 1U].foreign) out.push_back(node);
  }
  return out;
}

Result<bool> has_power(Session& session, std::uint8_t node) {
  const auto word = session.upload(node, objects::kStatusword);
  if (!word) return fail(word.error());
  return word->size() == 2 &&
         drive::is_energised(drive::decode_state(static_cast<std::uint16_t>(load_le(*word))));
}

Result<void> change_al_state(Session& session, EtherCatNetwork& ring, std::uint8_t node, NodeState target) {
  const auto seen = ring.look(false);
  if (!seen) return fail(seen.error());
  if (node > seen->size()) return fail(no_slave_at(node, seen->size()));
  const auto& slave = (*seen)[node - 1U];
  const auto& al = slave.look.al;
  const bool stays = node_state(al.state) == target && !al.error && ring.image_of(node) != nullptr;
  if (!stays && !slave.foreign && serves_objects(al.state))
    if (const auto free = check_without_power(session, node); !free) return free;
  return ring.request_state(node, target);
}

}  // namespace servoctl::session
