#include "motion/producer_claim.hpp"

#include "base/format.hpp"
#include "session/can_network.hpp"

namespace servoctl::motion {
namespace {

/// So much apart are claims of those who wait for different numbers of slots: longer than a frame takes from
/// one process to another.
constexpr Duration kSlot = std::chrono::milliseconds(6);
constexpr std::uint32_t kSlots = 8;
constexpr unsigned kSlotBits = 3;
/// Who meets the same masters again and again has other slots than they have by then.
constexpr unsigned kMostRounds = 10;

Error contested(std::uint8_t id) {
  return fail(Errc::refused,
              message("another master sends heartbeats as node {} (0x{:03X}): the drive would not notice if "
                      "servoctl died",
                      id, 0x700U + id),
              message("stop the other master, or use another node-ID: --master-node {}",
                      id > 1 ? id - 1 : 127))
      .value();
}

/// Whether nobody else was heard under the number until the end of the claim.
Result<bool> claim(session::Session& session, session::CanNetwork& can, std::uint8_t id, Duration back_off) {
  const auto begin = session.now();
  const auto heard = [&] { return session.watch().state(id).has_value(); };
  const auto before = session.wait(heard, begin + back_off);
  if (!before || *before) return before.map([](bool found) { return !found; });
  if (const auto all = session.listen(); !all) return fail(all.error());
  if (heard()) return false;
  if (const auto sent = can.send_heartbeat(id); !sent) return fail(sent.error());
  return session.wait(heard, begin + kClaiming).map([](bool found) { return !found; });
}

}  // namespace

Result<void> claim_producer(session::Session& session, std::uint8_t node, std::optional<std::uint8_t> named,
                            WatchdogPlan& plan) {
  auto* can = session.can();
  if (can == nullptr || plan.kind != WatchdogPlan::Kind::heartbeat) return {};
  for (unsigned round = 0; round < kMostRounds; ++round) {
    const auto slot = (session.options().claim_seed >> (kSlotBits * round)) % kSlots;
    const auto own = claim(session, *can, plan.producer, kSlot * slot);
    if (!own) return fail(own.error());
    if (*own) return {};
    if (named) break;
    const auto next = next_producer(session, node, plan.watched);
    if (!next) return fail(next.error());
    if (!*next) break;
    plan.producer = **next;
  }
  return fail(contested(plan.producer));
}

Result<void> check_producer(session::Session& session) {
  auto* can = session.can();
  const auto own = can == nullptr ? std::nullopt : can->heartbeat_node();
  if (own && session.watch().state(*own)) return fail(contested(*own));
  return {};
}

}  // namespace servoctl::motion
