#include "motion/watchdog.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/error_control.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "motion/power.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {
namespace {

constexpr std::uint8_t kMostEntries = 8;
/// A node answers within some milliseconds.
constexpr Duration kProbe = std::chrono::milliseconds(50);

bool has(const drive::Profile& profile, ObjectAddress object) {
  return profile.dictionary.find(object) != nullptr;
}

std::uint8_t node_of(std::uint64_t entry) { return canopen::watched_node(static_cast<std::uint32_t>(entry)); }

/// Whether a node is there that has not been heard: its heartbeats must not be sent by two.
bool answers(session::Session& session, std::uint8_t node) {
  const session::Hurry hurry(session, kProbe, 0);
  const auto answer = session.upload(node, objects::kDeviceType);
  return answer || answer.error().code == Errc::sdo_abort;
}

/// Takes in what all send, until the bus has been listened to for long enough.
Result<void> hear_others(session::Session& session) {
  const auto waited = session.wait([] { return false; }, session.opened_at() + kListening);
  if (!waited) return fail(waited.error());
  return session.listen();
}

Result<std::optional<std::uint8_t>> free_producer(session::Session& session, std::uint8_t node,
                                                  const std::set<std::uint8_t>& watched,
                                                  Listening listening) {
  const auto heard = listening == Listening::full ? hear_others(session) : session.listen();
  if (!heard) return fail(heard.error());
  return next_producer(session, node, watched);
}

Result<WatchdogPlan> plan_heartbeat(session::Session& session, const drive::Profile& profile,
                                    std::uint8_t node, std::optional<std::uint8_t> producer,
                                    Listening listening) {
  std::vector<session::SdoRequest> requests;
  for (std::uint8_t sub = 1; sub <= kMostEntries; ++sub)
    if (has(profile, {objects::kConsumerHeartbeatIndex, sub}))
      requests.push_back({.node = node, .object = {objects::kConsumerHeartbeatIndex, sub}});
  const auto answers = session.transfer(requests);
  bool any = false;
  std::uint8_t own = 0;
  WatchdogPlan plan;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i] && answers[i].error().code != Errc::sdo_abort) return fail(answers[i].error());
    if (!answers[i]) continue;
    any = true;
    const auto entry = load_le(*answers[i]);
    const auto watched = node_of(entry);
    if (watched != 0) plan.watched.insert(watched);
    if (plan.entry == 0 && watched == 0) plan.entry = requests[i].object.sub;
    // One that is left from before is used again: a drive takes no second entry for the same node.
    if (watched != 0 && watched == producer) own = requests[i].object.sub;
  }
  if (own != 0) plan.entry = own;
  if (plan.entry == 0) {
    if (any) plan.remark = "all entries of 1016h are taken";
    return plan;
  }
  const auto id = producer ? Result<std::optional<std::uint8_t>>(producer)
                           : free_producer(session, node, plan.watched, listening);
  if (!id) return fail(id.error());
  if (!*id) {
    plan.remark = "no node-ID is free for servoctl's heartbeat";
    return plan;
  }
  plan.kind = WatchdogPlan::Kind::heartbeat;
  plan.time = kWatchdogTime;
  plan.producer = **id;
  if (!producer && listening == Listening::so_far)
    plan.remark =
        "before it moves, servoctl listens for 1 s and takes another node-ID where this one is in use";
  return plan;
}

/// The number in an object; empty where the drive does not give it.
Result<std::optional<std::uint64_t>> number(session::Session& session, std::uint8_t node,
                                            ObjectAddress object) {
  const auto value = session.upload(node, object);
  if (!value && value.error().code != Errc::sdo_abort) return fail(value.error());
  return value ? std::optional(load_le(*value)) : std::nullopt;
}

/// Why life guarding would stop nothing; empty when it does.
Result<std::string> against_guarding(session::Session& session, const drive::Profile& profile,
                                     std::uint8_t node) {
  for (const auto object : {objects::kGuardTime, objects::kLifeTimeFactor}) {
    const auto there = number(session, node, object);
    if (!there) return fail(there.error());
    if (!*there) return formatted("it has no {}", to_string(object));
  }
  if (has(profile, objects::kProducerHeartbeat)) {
    const auto period = number(session, node, objects::kProducerHeartbeat);
    if (!period) return fail(period.error());
    // CiA 301, 7.2.8.2.2: one of the two protocols.
    if (period->value_or(0) != 0) return "it sends heartbeats (1017h), so node guarding is not possible";
  }
  const auto& name = profile.rules.nmt.guarding_alarm;
  if (name.empty()) return {};
  const auto alarm = drive::resolve(&profile, name);
  if (!alarm) return fail(alarm.error());
  const auto on = number(session, node, alarm->address);
  if (!on) return fail(on.error());
  if (on->value_or(0) != 0) return {};
  const bool at_restart = drive::meaning(*alarm, node).effect == od::Effect::restart;
  return formatted("a life guarding timeout is not an alarm while {} is {}{}", name,
                   *on ? "0" : "not readable",
                   at_restart ? " (a change takes effect when the drive starts)" : "");
}

/// Life guarding where it stops the drive.
Result<void> plan_guarding(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                           WatchdogPlan& plan) {
  const auto why_not = against_guarding(session, profile, node);
  if (!why_not) return fail(why_not.error());
  if (!why_not->empty()) {
    plan.remark += (plan.remark.empty() ? "" : ", and ") + *why_not;
    return {};
  }
  const auto& alarm = profile.rules.nmt.guarding_alarm;
  plan.remark = alarm.empty() ? "" : formatted("provided that {} was on when the drive started", alarm);
  plan.kind = WatchdogPlan::Kind::guarding;
  plan.time = 2 * kWatchdogTime;
  return {};
}

/// What the drive does when its watchdog has noticed, by 1029h and 6007h.
Result<void> find_reaction(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                           WatchdogPlan& plan) {
  if (profile.rules.nmt.disables_outside_operational) {
    const auto behaviour = number(session, node, objects::kCommunicationErrorBehaviour);
    if (!behaviour) return fail(behaviour.error());
    plan.power_off = *behaviour && leaves_operational(static_cast<std::uint8_t>(**behaviour));
  }
  if (!has(profile, objects::kAbortConnectionOption)) return {};
  const auto option = session.upload(node, objects::kAbortConnectionOption);
  if (!option && option.error().code != Errc::sdo_abort) return fail(option.error());
  if (!option || option->empty()) return {};
  const auto meaning = drive::meaning(drive::target_at(&profile, objects::kAbortConnectionOption), node);
  plan.reaction_off = load_le(*option) == 0;
  plan.option = plan.reaction_off ? kReactWithFault : static_cast<std::int16_t>(load_le(*option));
  const auto value =
      od::decode(meaning.type, plan.reaction_off ? store_le(kReactWithFault, option->size()) : *option);
  const auto* label = value ? drive::label_of(meaning, *value) : nullptr;
  if (label != nullptr) plan.reaction = label->label;
  return {};
}

/// What a drive does when it leaves OP is no part of the standard.
WatchdogPlan plan_outputs(const drive::Profile& profile) {
  WatchdogPlan plan;
  plan.kind = WatchdogPlan::Kind::sync_manager;
  plan.time = kOutputsTime;
  plan.alarms = profile.rules.nmt.lost_alarms;
  plan.assumed = true;
  return plan;
}

}  // namespace

Result<std::optional<std::uint8_t>> next_producer(session::Session& session, std::uint8_t node,
                                                  const std::set<std::uint8_t>& watched) {
  for (std::uint8_t id = canopen::kLastNode; id >= canopen::kFirstNode; --id)
    if (id != node && watched.count(id) == 0 && !session.watch().state(id) && !answers(session, id))
      return std::optional(id);
  return std::optional<std::uint8_t>();
}

Result<WatchdogPlan> plan_watchdog(session::Session& session, const drive::Profile& profile,
                                   std::uint8_t node, std::optional<std::uint8_t> producer,
                                   Listening listening) {
  if (producer && *producer == node)
    return fail(Errc::usage, message("{} is the drive's own node-ID", node),
                "give servoctl a different one, such as 127");
  if (producer && session.watch().state(*producer))
    return fail(Errc::refused, message("--master-node {}: this node-ID is already in use", *producer),
                "leave it out, and servoctl takes a free node-ID");
  using Sign = session::LifeSign::Kind;
  const auto& network = session.network();
  if (network.carries(Sign::process_data)) {
    if (producer)
      return fail(Errc::usage, "--master-node: there are no heartbeats on EtherCAT",
                  "leave it out: the drive has the watchdog of its process data there");
    return plan_outputs(profile);
  }
  auto plan = network.carries(Sign::heartbeat) ? plan_heartbeat(session, profile, node, producer, listening)
                                               : Result<WatchdogPlan>(WatchdogPlan{});
  if (!plan) return plan;
  if (plan->kind == WatchdogPlan::Kind::none && network.carries(Sign::guarding) &&
      has(profile, objects::kGuardTime) && has(profile, objects::kLifeTimeFactor)) {
    if (const auto done = plan_guarding(session, profile, node, *plan); !done) return fail(done.error());
  }
  plan->assumed = profile.rules.is_assumed("watchdog");
  plan->alarms = profile.rules.nmt.lost_alarms;
  plan->fault = lost_master_fault(profile);
  if (plan->kind == WatchdogPlan::Kind::none) return plan;
  if (const auto known = find_reaction(session, profile, node, *plan); !known) return fail(known.error());
  return plan;
}

std::string to_string(const WatchdogPlan& plan) {
  auto then = plan.reaction.empty() ? std::string() : formatted("; its reaction: {}", plan.reaction);
  if (!plan.remark.empty()) then += "; " + plan.remark;
  if (plan.assumed)
    then += "; ASSUMED: the manual does not say what the motor then does";
  else if (plan.stops() != Stops::yes)
    then += plan.option ? formatted("; NOT KNOWN is what the motor then does: 6007h = {} does not tell it",
                                    *plan.option)
                        : "; NOT KNOWN is what the motor then does: no 6007h tells it";
  switch (plan.kind) {
    case WatchdogPlan::Kind::heartbeat:
      return formatted("servoctl sends heartbeats as node {}: the drive notices {} after the last one{}",
                       plan.producer, servoctl::to_string(plan.time), then);
    case WatchdogPlan::Kind::guarding:
      return formatted("life guarding by servoctl: the drive notices {} after the last request{}",
                       servoctl::to_string(plan.time), then);
    case WatchdogPlan::Kind::sync_manager:
      return formatted(
          "sync manager watchdog: the drive leaves OP by itself {} after the last outputs{}{}",
          servoctl::to_string(plan.time),
          plan.alarms.empty() ? std::string() : formatted(" (alarm {})", fmt::join(plan.alarms, ", ")), then);
    case WatchdogPlan::Kind::none: break;
  }
  auto none =
      plan.alarms.empty()
          ? std::string("none: nothing is known that stops the drive if the cable is cut or servoctl dies")
          : formatted(
                "none that servoctl can arm: the manual names alarm {} for lost communication, but not "
                "whether and when the motor stops; if only servoctl dies it may keep turning",
                fmt::join(plan.alarms, ", "));
  return none + (plan.remark.empty() ? "" : "; " + plan.remark);
}

std::string expectation(const WatchdogPlan& plan, bool armed) {
  const auto time = servoctl::to_string(plan.time);
  armed = armed && plan.kind != WatchdogPlan::Kind::none;
  LostMaster unwatched;
  unwatched.alarms = !plan.alarms.empty();
  switch (armed ? plan.stops() : unwatched.stops()) {
    case Stops::yes:
      return formatted("its watchdog is set to stop it {} after the last message; that was not seen", time);
    case Stops::unknown:
      if (!armed) return "whether it stops by itself is not known";
      return formatted(
          "its watchdog notices {} after the last message; whether the motor then stops is not known", time);
    case Stops::no: break;
  }
  return "nothing is known that stops it by itself";
}

}  // namespace servoctl::motion
