#include "session/node_life.hpp"

#include <algorithm>

#include "base/bytes.hpp"
#include "drive/standard_objects.hpp"
#include "session/can_network.hpp"
#include "session/identify.hpp"
#include "session/option_scope.hpp"

namespace servoctl::session {
namespace {

/// A heartbeat period that is longer is not waited for.
constexpr Duration kMostPeriod = std::chrono::seconds(2);
/// Longest wait for a heartbeat that tells the NMT state.
constexpr Duration kMostWait = std::chrono::seconds(3);

/// Between two heartbeats of a node; of one whose period nobody knows, as long as may be.
Duration longest_silence(Duration period) {
  return period == Duration::zero() ? kMostPeriod : std::min(kMostPeriod, period * 3 / 2);
}

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
    nodes[i].answers = code != Errc::timeout;
    nodes[i].alive = nodes[i].alive || nodes[i].answers;
  }
  return {};
}

Result<void> wait_for_answers(Session& session, std::span<NodeLife> nodes, Duration patience) {
  const auto until = session.now() + patience;
  do {
    if (const auto asked = ask_who_answers(session, nodes); !asked) return asked;
    if (std::ranges::all_of(nodes, &NodeLife::alive)) return {};
    const auto paused = session.wait([] { return false; }, session.now() + std::chrono::milliseconds(100));
    if (!paused) return fail(paused.error());
  } while (session.now() < until);
  return {};
}

Result<void> hold_single(Session& session, std::span<NodeLife> nodes) {
  if (const auto asked = ask_who_answers(session, nodes); !asked) return asked;
  std::vector<std::uint8_t> ids;
  for (const auto& one : nodes) ids.push_back(one.node);
  if (const auto heard = settle_duplicates(session, ids, kBeforeMotion); !heard) return heard;
  for (const auto node : ids)
    if (const auto single = refuse_duplicate(session, node); !single) return single;
  return {};
}

Result<void> look_for_second(Session& session, std::span<NodeLife> nodes) {
  if (const auto asked = ask_who_answers(session, nodes); !asked) return asked;
  std::vector<std::uint8_t> ids;
  for (const auto& one : nodes)
    if (one.answers) ids.push_back(one.node);
  if (ids.empty() || session.can() == nullptr) return {};
  return settle_duplicates(session, ids, kBeforeMotion);
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
      patience = std::max(patience, longest_silence(can->watch().period(one.node)));
    if (!guards) continue;
    if (const auto asked = session.network().ask_state(one.node); !asked) return asked;
  }
  const auto waited = session.wait(heard, session.now() + patience);
  return waited ? Result<void>() : fail(waited.error());
}

Result<void> hear_states(Session& session, std::span<const HeartbeatPeriod> periods) {
  Duration longest{};
  std::vector<std::uint8_t> expected;
  for (const auto& [node, period] : periods) {
    if (period == Duration::zero() || session.watch().state(node)) continue;
    expected.push_back(node);
    longest = std::max<Duration>(longest, period * 3 / 2);
  }
  if (expected.empty()) return {};
  const auto all_heard = [&] {
    return std::ranges::all_of(expected, [&](auto node) { return session.watch().state(node).has_value(); });
  };
  const auto heard = session.wait(all_heard, session.now() + std::min(longest, kMostWait));
  return heard ? Result<void>() : fail(heard.error());
}

Heartbeats read_heartbeats(Session& session, std::span<const std::uint8_t> nodes) {
  std::vector<SdoRequest> requests;
  for (const auto node : nodes)
    requests.push_back({.node = node, .object = objects::kProducerHeartbeat, .size = 2});
  const auto answers = session.transfer(requests);
  Heartbeats out;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (auto* can = session.can()) out.longest = std::max(out.longest, can->watch().period(nodes[i]));
    if (!answers[i] || answers[i]->size() > 8) continue;
    const auto period = std::chrono::milliseconds(load_le(*answers[i]) & 0xFFFFU);
    out.longest = std::max<Duration>(out.longest, period);
    if (period == Duration::zero()) out.silent.push_back(nodes[i]);
  }
  return out;
}

}  // namespace servoctl::session
