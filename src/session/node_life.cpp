#include "session/node_life.hpp"

#include <algorithm>

#include "drive/standard_objects.hpp"
#include "session/can_network.hpp"
#include "session/option_scope.hpp"

namespace servoctl::session {
namespace {

/// A heartbeat period that is longer is not waited for.
constexpr Duration kMostPeriod = std::chrono::seconds(2);

}  // namespace

std::vector<NodeLife> look_from_now(const Session& session, std::span<const std::uint8_t> nodes) {
  std::vector<NodeLife> out;
  for (const auto node : nodes)
    out.push_back({node, session.watch().boots(node), session.watch().heartbeats(node)});
  return out;
}

Result<void> ask_who_answers(Session& session, std::span<NodeLife> nodes) {
  // A recording answers nothing but what it was asked.
  if (session.url().starts_with("replay:")) return {};
  std::vector<SdoRequest> questions;
  for (const auto& one : nodes) questions.push_back({.node = one.node, .object = objects::kDeviceType});
  const OptionScope once(session, &Options::retries, 0U);
  const auto answers = session.transfer(questions);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto code = answers[i] ? Errc::negative : answers[i].error().code;
    if (code == Errc::bus || code == Errc::interrupted) return fail(answers[i].error());
    nodes[i].alive = nodes[i].alive || code != Errc::timeout;
  }
  return {};
}

Result<void> hear_who_lives(Session& session, std::span<NodeLife> nodes, Duration patience) {
  const auto heard = [&] {
    for (auto& one : nodes)
      one.alive = one.alive || session.watch().boots(one.node) > one.boots ||
                  session.watch().heartbeats(one.node) > one.heartbeats;
    return std::ranges::all_of(nodes, &NodeLife::alive);
  };
  if (heard()) return {};
  const bool guards = session.network().carries(LifeSign::Kind::guarding);
  for (const auto& one : nodes) {
    if (one.alive) continue;
    if (auto* can = session.can())
      patience = std::max(patience, std::min(kMostPeriod, can->watch().period(one.node) * 3 / 2));
    if (!guards) continue;
    if (const auto asked = session.network().ask_state(one.node); !asked) return asked;
  }
  const auto waited = session.wait(heard, session.now() + patience);
  return waited ? Result<void>() : fail(waited.error());
}

}  // namespace servoctl::session
