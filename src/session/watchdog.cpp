#include "session/watchdog.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "base/duration.hpp"
#include "canopen/cob_id.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/hurry.hpp"
#include "session/power.hpp"

namespace servoctl::session {
namespace {

constexpr std::uint8_t kMostEntries = 8;
/// A node answers within some milliseconds.
constexpr Duration kProbe = std::chrono::milliseconds(50);

bool has(const drive::Profile& profile, ObjectAddress object) {
  return profile.dictionary.find(object) != nullptr;
}

std::uint8_t node_of(std::uint64_t entry) { return static_cast<std::uint8_t>(entry >> 16U & 0x7FU); }
bool is_free(std::uint64_t entry) { return node_of(entry) == 0 || (entry & 0xFFFFU) == 0; }

/// Whether a node is there that has not been heard: its heartbeats must not be sent by two.
bool answers(Session& session, std::uint8_t node) {
  const Hurry hurry(session, kProbe, 0);
  const auto answer = session.upload(node, objects::kDeviceType);
  return answer || answer.error().code == Errc::sdo_abort;
}

/// Node-ID for servoctl: not the drive's, not one that was heard or that the drive watches already.
std::optional<std::uint8_t> free_producer(Session& session, std::uint8_t node,
                                          const std::vector<std::uint64_t>& entries) {
  for (std::uint8_t id = canopen::kLastNode; id >= canopen::kFirstNode; --id) {
    const bool watched =
        std::any_of(entries.begin(), entries.end(), [&](auto e) { return !is_free(e) && node_of(e) == id; });
    if (id != node && !watched && !session.watch().state(id) && !answers(session, id)) return id;
  }
  return std::nullopt;
}

Result<WatchdogPlan> plan_heartbeat(Session& session, const drive::Profile& profile, std::uint8_t node,
                                    std::optional<std::uint8_t> producer) {
  std::vector<SdoRequest> requests;
  for (std::uint8_t sub = 1; sub <= kMostEntries; ++sub)
    if (has(profile, {objects::kConsumerHeartbeatIndex, sub}))
      requests.push_back({.node = node, .object = {objects::kConsumerHeartbeatIndex, sub}});
  const auto answers = session.transfer(requests);
  std::vector<std::uint64_t> entries;
  WatchdogPlan plan;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i] && answers[i].error().code != Errc::sdo_abort)
      return tl::unexpected<Error>(answers[i].error());
    if (!answers[i]) continue;
    entries.push_back(load_le(*answers[i]));
    if (plan.entry == 0 && is_free(entries.back())) plan.entry = requests[i].object.sub;
  }
  const auto id = producer ? producer : free_producer(session, node, entries);
  if (plan.entry == 0 || !id) return WatchdogPlan{};
  plan.kind = WatchdogPlan::Kind::heartbeat;
  plan.time = kWatchdogTime;
  plan.producer = *id;
  return plan;
}

/// Whether life guarding would stop the drive: one that sends heartbeats is not guarded (CiA 301, 7.2.8.2.2),
/// and some mask the alarm.
Result<bool> can_guard(Session& session, const drive::Profile& profile, std::uint8_t node) {
  if (!has(profile, objects::kGuardTime) || !has(profile, objects::kLifeTimeFactor)) return false;
  std::vector<SdoRequest> requests;
  for (const auto object : {objects::kGuardTime, objects::kLifeTimeFactor, objects::kProducerHeartbeat})
    requests.push_back({.node = node, .object = object});
  const auto* alarm = profile.parameter(profile.rules.nmt.guarding_alarm);
  if (alarm != nullptr && alarm->object) requests.push_back({.node = node, .object = *alarm->object});
  const auto answers = session.transfer(requests);
  for (const auto& answer : answers)
    if (!answer && answer.error().code != Errc::sdo_abort) return tl::unexpected<Error>(answer.error());
  const bool beats = answers[2] && load_le(*answers[2]) != 0;
  const bool masked = answers.size() > 3 && answers[3] && load_le(*answers[3]) == 0;
  return answers[0] && answers[1] && !beats && !masked;
}

}  // namespace

Result<WatchdogPlan> plan_watchdog(Session& session, const drive::Profile& profile, std::uint8_t node,
                                   std::optional<std::uint8_t> producer) {
  if (producer && *producer == node)
    return fail(Errc::usage, fmt::format("{} is the drive's own node-ID", node),
                "give servoctl another one, such as 127");
  auto plan = plan_heartbeat(session, profile, node, producer);
  if (!plan) return plan;
  if (plan->kind == WatchdogPlan::Kind::none) {
    const auto guards = can_guard(session, profile, node);
    if (!guards) return tl::unexpected<Error>(guards.error());
    if (*guards) plan->kind = WatchdogPlan::Kind::guarding;
    if (*guards) plan->time = 2 * kWatchdogTime;
  }
  if (plan->kind == WatchdogPlan::Kind::none || !has(profile, objects::kAbortConnectionOption)) return plan;
  const auto option = session.upload(node, objects::kAbortConnectionOption);
  if (!option) return plan;
  const auto meaning = drive::meaning(drive::target_at(&profile, objects::kAbortConnectionOption), node);
  plan->reaction_off = load_le(*option) == 0;
  const auto value =
      od::decode(meaning.type, plan->reaction_off ? store_le(kReactWithFault, option->size()) : *option);
  const auto* label = value ? drive::label_of(meaning, *value) : nullptr;
  if (label != nullptr) plan->reaction = label->label;
  return plan;
}

std::string to_string(const WatchdogPlan& plan) {
  const auto then =
      plan.reaction.empty() ? std::string() : fmt::format("; it reacts with: {}", plan.reaction);
  switch (plan.kind) {
    case WatchdogPlan::Kind::heartbeat:
      return fmt::format(
          "heartbeat of servoctl as node {}: the drive stops by itself {} after the last one{}",
          plan.producer, servoctl::to_string(plan.time), then);
    case WatchdogPlan::Kind::guarding:
      return fmt::format("life guarding by servoctl: the drive stops by itself {} after the last question{}",
                         servoctl::to_string(plan.time), then);
    case WatchdogPlan::Kind::none: break;
  }
  return "none: nothing stops the drive when the cable is cut or servoctl dies";
}

}  // namespace servoctl::session
