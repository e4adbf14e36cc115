#include "pdo/pdo_neighbours.hpp"

#include <algorithm>
#include <optional>

#include "base/format.hpp"
#include "session/option_scope.hpp"
#include "show/pdo_report.hpp"

namespace servoctl::pdo {
namespace {

using canopen::Pdo;
using canopen::PdoDirection;

/// One that is there answers sooner; one that is not would hold up every change.
constexpr Duration kPatience = std::chrono::milliseconds(100);

bool has_can_id(const Pdo& pdo, std::uint32_t can_id) { return pdo.is_valid() && pdo.can_id() == can_id; }

/// The valid PDOs of a change that had this CAN-ID not before.
std::vector<Pdo> newly_given(const PdoNeighbour& node) {
  std::vector<Pdo> out;
  for (const auto& pdo : node.wanted) {
    const bool had = std::any_of(node.present.begin(), node.present.end(), [&](const Pdo& before) {
      return before.direction == pdo.direction && has_can_id(before, pdo.can_id());
    });
    if (pdo.is_valid() && !had) out.push_back(pdo);
  }
  return out;
}

/// The PDO that the pre-defined connection set gives this CAN-ID, with its node; empty for other CAN-IDs.
struct Owner {
  std::uint8_t node = 0;
  Pdo pdo;
};
std::optional<Owner> owner_of(const Pdo& pdo) {
  constexpr std::uint32_t kFirst = 0x180;
  constexpr std::uint32_t kLast = 0x57F;
  const auto can_id = pdo.can_id();
  const auto node = static_cast<std::uint8_t>(can_id & 0x7FU);
  if (can_id < kFirst || can_id > kLast || node == 0) return std::nullopt;
  const auto block = (can_id - kFirst) / 0x80;  // TPDO1, RPDO1, TPDO2, …
  Owner out{node, {block % 2 == 0 ? PdoDirection::transmit : PdoDirection::receive}};
  out.pdo.number = static_cast<std::uint16_t>(block / 2 + 1);
  return out;
}

class Neighbours {
 public:
  Neighbours(show::Desk& desk, std::span<const PdoNeighbour> nodes) : desk_(&desk), nodes_(nodes) {}

  Result<void> run() {
    for (const auto& node : nodes_)
      for (const auto& pdo : newly_given(node))
        if (const auto done = check(node.node, pdo); !done) return done;
    return {};
  }

 private:
  Result<void> check(std::uint8_t node, const Pdo& pdo) {
    for (const auto& other : nodes_)
      for (const auto& theirs : other.wanted)
        if (other.node != node && has_can_id(theirs, pdo.can_id()))
          if (const auto done = judge(node, pdo, other.node, theirs); !done) return done;
    auto owner = owner_of(pdo);
    const bool changes = owner && std::any_of(nodes_.begin(), nodes_.end(),
                                              [&](const auto& n) { return n.node == owner->node; });
    if (!owner || changes) return {};
    const auto has = ask(*owner);
    if (!has) return fail(has.error());
    return *has ? judge(node, pdo, owner->node, owner->pdo) : Result<void>();
  }

  /// Whether the node is there and the PDO has its pre-defined CAN-ID.
  Result<bool> ask(Owner& owner) const {
    const session::Hurry hurry(*desk_->session, kPatience, 0);
    const auto answer = desk_->session->upload(owner.node, {owner.pdo.communication_index(), 1});
    if (!answer && (answer.error().code == Errc::bus || answer.error().code == Errc::interrupted))
      return fail(answer.error());
    if (!answer) return false;
    const auto wanted = (owner.pdo.number - 1U) * 0x100 +
                        (owner.pdo.direction == PdoDirection::transmit ? 0x180U : 0x200U) + owner.node;
    owner.pdo.cob_id = static_cast<std::uint32_t>(load_le(*answer));
    return has_can_id(owner.pdo, wanted);
  }

  Result<void> judge(std::uint8_t node, const Pdo& pdo, std::uint8_t other, const Pdo& theirs) {
    const auto mine = canopen::name(pdo.direction, pdo.number);
    const auto name = canopen::name(theirs.direction, theirs.number);
    const auto id = show::can_id_text(pdo.cob_id);
    if (pdo.direction == PdoDirection::receive && theirs.direction == PdoDirection::transmit) {
      desk_->notices.push_back(message("node {}: {} receives what {} of node {} sends with {}",
                                       node_name(node), mine, name, node_name(other), id));
      return {};
    }
    const auto what = pdo.direction == PdoDirection::receive      ? "one frame would control both"
                      : theirs.direction == PdoDirection::receive ? "what one sends would control the other"
                                                                  : "both would send it";
    return fail(drive_error(
        Errc::refused, node,
        message("{}: CAN-ID {} is used by {} of node {}: {}", mine, id, name, node_name(other), what),
        message("use another one, or `pdo disable {} -n {}` first", as_it_is(name), node_name(other))));
  }

  show::Desk* desk_;
  std::span<const PdoNeighbour> nodes_;
};

}  // namespace

Result<void> check_neighbours(show::Desk& desk, std::span<const PdoNeighbour> nodes) {
  return Neighbours(desk, nodes).run();
}

}  // namespace servoctl::pdo
