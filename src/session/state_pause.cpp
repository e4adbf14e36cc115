#include "session/state_pause.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "drive/standard_objects.hpp"
#include "session/answer.hpp"

namespace servoctl::session {
namespace {

/// Longest wait for a heartbeat.
constexpr Duration kMostPatience = std::chrono::seconds(3);

Result<void> tell(Session& session, std::uint8_t node, NodeState state) {
  session.network().doubt_state(node);
  return session.network().request_state(node, state);
}

/// Of a node that always answers.
Result<std::optional<NodeState>> answered_state(Session& session, std::uint8_t node) {
  const auto heard = session.watch().heartbeats(node);
  if (const auto asked = session.network().ask_state(node); !asked) return fail(asked.error());
  const auto waited = session.wait([&] { return session.watch().heartbeats(node) > heard; },
                                   session.now() + session.options().timeout);
  if (!waited) return fail(waited.error());
  return *waited ? session.watch().state(node) : std::nullopt;
}

}  // namespace

Result<std::optional<NodeState>> ask_state(Session& session, std::uint8_t node, bool by_question) {
  if (session.network().tells_state()) return answered_state(session, node);
  const SdoRequest questions[] = {{.node = node, .object = objects::kProducerHeartbeat, .size = 2},
                                  {.node = node, .object = objects::kGuardTime, .size = 2},
                                  {.node = node, .object = objects::kLifeTimeFactor, .size = 1}};
  const auto answers = session.transfer(questions);
  for (const auto& answer : answers)
    if (!answer && answer.error().code != Errc::sdo_abort) return fail(answer.error());
  const auto period = std::chrono::milliseconds(number_in(answers[0]).value_or(0) & 0xFFFFU);
  auto patience = std::min<Duration>(period * 3 / 2, kMostPatience);
  const auto heard = session.watch().heartbeats(node);
  if (period == Duration::zero()) {
    const bool is_guarded = number_in(answers[1]).value_or(0) != 0 && number_in(answers[2]).value_or(0) != 0;
    if (!by_question || is_guarded) return std::nullopt;
    const auto sent = session.network().ask_state(node);
    // Some buses carry no remote frame: then nobody can be asked.
    if (!sent && sent.error().code == Errc::usage) return std::nullopt;
    if (!sent) return fail(sent.error());
    patience = session.options().timeout;
  }
  const auto waited =
      session.wait([&] { return session.watch().heartbeats(node) > heard; }, session.now() + patience);
  if (!waited) return fail(waited.error());
  return *waited ? session.watch().state(node) : std::nullopt;
}

Result<void> StatePause::enter() {
  const auto state = ask_state(*session_, node_);
  if (!state) return fail(state.error());
  before_ = *state;
  if (before_ == NodeState::pre_operational) return {};
  entered_ = true;
  return tell(*session_, node_, NodeState::pre_operational);
}

Result<void> StatePause::leave(bool put_back) {
  if (!std::exchange(entered_, false)) return {};
  const bool known = before_ == NodeState::operational;
  if (known && put_back) return tell(*session_, node_, NodeState::operational);
  notices_.push_back(message("node {}: it stays {}, {}; `{}` starts it", node_name(node_),
                             session_->network().state_word(NodeState::pre_operational),
                             known ? "because a restore is incomplete"
                                   : "because neither heartbeat nor guarding showed its previous state",
                             session_->network().state_command(node_, NodeState::operational)));
  return {};
}

}  // namespace servoctl::session
