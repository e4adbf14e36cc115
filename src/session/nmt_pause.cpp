#include "session/nmt_pause.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "canopen/error_control.hpp"
#include "drive/standard_objects.hpp"
#include "session/answer.hpp"

namespace servoctl::session {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;

/// Longest wait for a heartbeat.
constexpr Duration kMostPatience = std::chrono::seconds(3);

Result<void> tell(Session& session, std::uint8_t node, NmtCommand command) {
  session.watch().on_command(node);
  return session.send(canopen::nmt_frame(command, node));
}

}  // namespace

Result<std::optional<NmtState>> ask_nmt_state(Session& session, std::uint8_t node, bool by_guarding) {
  const SdoRequest questions[] = {{.node = node, .object = objects::kProducerHeartbeat, .size = 2},
                                  {.node = node, .object = objects::kGuardTime, .size = 2},
                                  {.node = node, .object = objects::kLifeTimeFactor, .size = 1}};
  const auto answers = session.transfer(questions);
  for (const auto& answer : answers)
    if (!answer && answer.error().code != Errc::sdo_abort) return tl::unexpected<Error>(answer.error());
  const auto period = std::chrono::milliseconds(number_in(answers[0]).value_or(0) & 0xFFFFU);
  auto patience = std::min<Duration>(period * 3 / 2, kMostPatience);
  if (period == Duration::zero()) {
    const bool is_guarded = number_in(answers[1]).value_or(0) != 0 && number_in(answers[2]).value_or(0) != 0;
    if (!by_guarding || is_guarded) return std::nullopt;
    if (const auto sent = session.send(canopen::guarding_request(node)); !sent)
      return tl::unexpected<Error>(sent.error());
    patience = session.options().timeout;
  }
  const auto heard = session.watch().heartbeats(node);
  const auto waited =
      session.wait([&] { return session.watch().heartbeats(node) > heard; }, session.now() + patience);
  if (!waited) return tl::unexpected<Error>(waited.error());
  return *waited ? session.watch().state(node) : std::nullopt;
}

Result<void> NmtPause::enter() {
  const auto state = ask_nmt_state(*session_, node_);
  if (!state) return tl::unexpected<Error>(state.error());
  before_ = *state;
  if (before_ == NmtState::pre_operational) return {};
  entered_ = true;
  return tell(*session_, node_, NmtCommand::enter_pre_operational);
}

Result<void> NmtPause::leave(bool put_back) {
  if (!std::exchange(entered_, false)) return {};
  const bool known = before_ == NmtState::operational;
  if (known && put_back) return tell(*session_, node_, NmtCommand::start);
  notices_.push_back(fmt::format(
      "node {}: it stays pre-operational, {}; `nmt start -n {}` starts it", node_,
      known ? "because not all is as it was" : "because neither heartbeat nor guarding told its state before",
      node_));
  return {};
}

}  // namespace servoctl::session
