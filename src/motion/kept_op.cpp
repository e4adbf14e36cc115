#include "motion/kept_op.hpp"

#include "base/format.hpp"

namespace servoctl::motion {
namespace {

/// Longest wait for it to say in which state it is: one that is lost is left to its own watchdog soon.
constexpr Duration kAnswerPatience = std::chrono::milliseconds(200);

bool is_in_op(session::Session& session, std::uint8_t node) {
  const auto heard = session.watch().heartbeats(node);
  if (!session.network().ask_state(node)) return false;
  (void)session.wait([&] { return session.watch().heartbeats(node) != heard; },
                     session.now() + kAnswerPatience);
  return session.watch().state(node) == session::NodeState::operational;
}

}  // namespace

Result<void> renew_op(session::Session& session, std::uint8_t node) {
  auto& network = session.network();
  const bool still_there = is_in_op(session, node);
  auto back = network.end_exchange(node);
  if (back && !still_there) back = fail(Errc::negative, "it left it by itself");
  if (back) back = network.request_state(node, session::NodeState::operational);
  if (back) return {};
  auto error = back.error();
  error.message = message(
      "it was in {} before and is in {} now: {}", network.state_word(session::NodeState::operational),
      network.state_word(session.watch().state(node).value_or(session::NodeState::unknown)), error.message);
  return fail(std::move(error));
}

}  // namespace servoctl::motion
