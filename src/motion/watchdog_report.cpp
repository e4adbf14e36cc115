#include "motion/watchdog_report.hpp"

#include "base/duration.hpp"
#include "base/format.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "motion/watchdog.hpp"
#include "session/supervision.hpp"

namespace servoctl::motion {
namespace {

using session::Supervision;

/// CiA 301, 7.5.2.32.
std::string_view nmt_after_error(std::uint8_t behaviour) {
  switch (behaviour) {
    case 0: return "Operational becomes Pre-operational";
    case 1: return "stays as it is";
    case 2: return "becomes Stopped";
    default: return "not known";
  }
}

void add_heartbeats(const Supervision& found, WatchdogReport& out) {
  for (const auto& entry : found.entries)
    if (entry.node != 0)
      out.noticed_by.push_back(
          formatted("heartbeat of node {}, after {}", entry.node, servoctl::to_string(entry.time)));
}

/// Life guarding that raises no alarm notices nothing.
void add_guarding(const Supervision& found, const drive::Rules& rules, WatchdogReport& out) {
  const auto life = found.life_time();
  if (life == Duration::zero()) return;
  if (found.heartbeat.value_or(Duration{}) != Duration::zero())
    return out.remarks.push_back(
        "life guarding is set and has no effect: it sends heartbeats (1017h), and CiA 301 allows one of both");
  if (found.guarding_alarm && *found.guarding_alarm == 0)
    return out.remarks.push_back(
        formatted("life guarding is set, and raises no alarm while {} is 0", rules.nmt.guarding_alarm));
  out.noticed_by.push_back(formatted("life guarding, after {} without a request (from the first one on)",
                                     servoctl::to_string(life)));
}

void add_reaction(const Supervision& found, const drive::Profile& profile, WatchdogReport& out) {
  if (!found.abort_option) return;
  const auto what = drive::meaning(drive::target_at(&profile, objects::kAbortConnectionOption), found.node);
  const auto value = od::decode(what.type, store_le(*found.abort_option, 2));
  out.option = static_cast<std::int16_t>(*found.abort_option);
  const auto* label = value ? drive::label_of(what, *value) : nullptr;
  if (label != nullptr) out.reaction = label->label;
}

Stops judged(const drive::Rules& rules, const Supervision& found, WatchdogReport& out) {
  if (!out.noticed_by.empty() && out.option == 0)
    out.remarks.emplace_back("6007h is 0: it does nothing about it");
  const bool power_off = rules.nmt.disables_outside_operational && found.communication_error &&
                         leaves_operational(*found.communication_error);
  return LostMaster{!out.noticed_by.empty(), out.option,          power_off,
                    !out.fault.empty(),      !out.alarms.empty(), out.assumed}
      .stops();
}

WatchdogReport report_of(const Supervision& found, const drive::Profile& profile) {
  WatchdogReport out;
  out.node = found.node;
  out.alarms = profile.rules.nmt.lost_alarms;
  out.assumed = profile.rules.is_assumed("watchdog");
  add_heartbeats(found, out);
  add_guarding(found, profile.rules, out);
  add_reaction(found, profile, out);
  out.fault = lost_master_fault(profile);
  if (found.communication_error) out.nmt_state = nmt_after_error(*found.communication_error);
  if (found.entries.empty() && !found.guard_time)
    out.remarks.emplace_back("it has neither 1016h nor 100Ch: it watches no master over CANopen");
  if (profile.rules.nmt.disables_outside_operational)
    out.remarks.emplace_back("leaving Operational de-energises it");
  out.stops = judged(profile.rules, found, out);
  return out;
}

/// Outputs that stay away end OP; what the drive does then is no part of the standard.
void add_outputs(WatchdogReport& out) {
  out.noticed_by.push_back(
      formatted("sync manager watchdog: in OP, when its outputs stay away (motions of servoctl: after {})",
                servoctl::to_string(kOutputsTime)));
  out.remarks.clear();
  out.fault.clear();
  out.assumed = true;
  out.stops = Stops::unknown;
}

}  // namespace

std::vector<Result<WatchdogReport>> read_watchdogs(session::Session& session, const drive::Profile& profile,
                                                   std::span<const std::uint8_t> nodes) {
  std::vector<Result<WatchdogReport>> out;
  for (const auto& found : session::read_supervision(session, profile, nodes)) {
    if (!found) {
      out.emplace_back(fail(found.error()));
      continue;
    }
    out.emplace_back(report_of(*found, profile));
    if (session.network().is_ring()) add_outputs(*out.back());
  }
  return out;
}

}  // namespace servoctl::motion
