#include "session/ring_scan.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "session/scan.hpp"

namespace servoctl::session {
namespace {

using ethercat::AlState;

std::uint8_t node_at(std::size_t index) { return static_cast<std::uint8_t>(index + 1); }

/// An SII of zeros says nothing.
Identity identity_of(std::uint8_t node, const EtherCatNetwork::Seen& seen) {
  Identity out;
  out.node = node;
  out.state = node_state(seen.look.al.state);
  if (!seen.sii || seen.sii->is_empty()) return out;
  out.vendor_id = seen.sii->vendor;
  out.product_code = seen.sii->product;
  out.revision = seen.sii->revision;
  out.serial = seen.sii->serial;
  return out;
}

std::vector<std::string> doubts_of(const EtherCatNetwork::Seen& seen) {
  if (!seen.sii)
    return seen.foreign || seen.sii_error.empty() ? std::vector<std::string>{} : std::vector{seen.sii_error};
  if (seen.sii->is_empty() && seen.sii->doubts.empty()) return {"it does not say what the slave is"};
  return seen.sii->doubts;
}

bool serves_objects(const EtherCatNetwork::Seen& seen) {
  const auto state = seen.look.al.state;
  return state == AlState::preop || state == AlState::safeop || state == AlState::op;
}

void compare(std::vector<std::string>& doubts, std::string_view what, const std::optional<std::uint32_t>& sii,
             const std::optional<std::uint32_t>& object) {
  if (sii && object && *sii != *object)
    doubts.push_back(formatted("it says {} 0x{:X}, and the drive itself 0x{:X}", what, *sii, *object));
}

/// What the drive says of itself goes before what somebody has written into its SII.
void merge(RingSlave& slave, Identity said) {
  const auto by_sii = std::exchange(slave.identity, std::move(said));
  auto& identity = slave.identity;
  compare(slave.doubts, "vendor", by_sii.vendor_id, identity.vendor_id);
  compare(slave.doubts, "product", by_sii.product_code, identity.product_code);
  if (!identity.vendor_id) identity.vendor_id = by_sii.vendor_id;
  if (!identity.product_code) identity.product_code = by_sii.product_code;
  if (!identity.revision) identity.revision = by_sii.revision;
  if (!identity.serial) identity.serial = by_sii.serial;
  identity.state = by_sii.state;
  slave.has_objects = true;
}

/// No address has to be given, and no state entered, to ask for objects.
std::vector<std::uint8_t> open_nodes(const RingScan& ring) {
  std::vector<std::uint8_t> out;
  for (std::size_t i = 0; i < ring.slaves.size(); ++i) {
    const auto& seen = ring.slaves[i].seen;
    if (seen.foreign || seen.look.station != station_of(node_at(i))) return {};
    if (serves_objects(seen)) out.push_back(node_at(i));
  }
  return out;
}

}  // namespace

std::uint8_t RingScan::foreign() const {
  const auto found = std::find_if(slaves.begin(), slaves.end(), [](const auto& s) { return s.seen.foreign; });
  return found == slaves.end() ? 0 : node_at(static_cast<std::size_t>(found - slaves.begin()));
}

Result<RingScan> scan_ring(Session& session, EtherCatNetwork& ring) {
  auto seen = ring.look(true);
  if (!seen) return fail(seen.error());
  RingScan out;
  out.count = ring.count();
  for (auto& slave : *seen) {
    auto identity = identity_of(node_at(out.slaves.size()), slave);
    auto doubts = doubts_of(slave);
    out.slaves.push_back({std::move(slave), std::move(identity), false, std::move(doubts)});
  }
  if (const auto nodes = open_nodes(out); !nodes.empty()) {
    auto said = scan(session, nodes);
    if (!said) return fail(said.error());
    for (auto& identity : *said) {
      auto& slave = out.slaves[identity.node - 1U];
      merge(slave, std::move(identity));
    }
  }
  return out;
}

}  // namespace servoctl::session
