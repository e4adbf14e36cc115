#include <fmt/format.h>

#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "motion/watchdog_report.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using motion::WatchdogReport;
using report::Show;
using report::Value;

report::Value texts(const std::vector<std::string>& words) {
  report::List out;
  for (const auto& word : words) out.emplace_back(word);
  return Value(std::move(out));
}

std::string joined_or(const std::vector<std::string>& words, std::string_view none) {
  return words.empty() ? std::string(none) : fmt::to_string(fmt::join(words, "; "));
}

std::string reaction_text(const WatchdogReport& one) {
  std::string out;
  if (one.option)
    out = formatted("{} (6007h = {})", one.reaction.empty() ? "not known" : one.reaction, *one.option);
  if (!one.fault.empty() && !one.noticed_by.empty() && one.option != 0)
    append(out, formatted("fault 8130h, {}", one.fault), "; ");
  if (!one.nmt_state.empty()) append(out, "NMT state " + one.nmt_state, "; ");
  if (!one.alarms.empty()) append(out, formatted("alarm {}", fmt::join(one.alarms, ", ")), "; ");
  return out.empty() ? std::string("not known") : out;
}

report::Record watchdog_record(const WatchdogReport& one) {
  auto remarks = one.remarks;
  if (one.assumed) remarks.emplace_back("ASSUMED: the manual does not say what the motor then does");
  return {{"node", one.node},
          {"stops", std::string(motion::text_of(one.stops)), Show::everywhere, "stops without its master"},
          {"noticed_by", joined_or(one.noticed_by, "nothing"), Show::text, "noticed by"},
          {"noticed_by", texts(one.noticed_by), Show::json},
          {"reaction", reaction_text(one), Show::text},
          {"abort_option", one.option ? Value(*one.option) : Value(), Show::json},
          {"reaction", report::text_or_null(one.reaction), Show::json},
          {"nmt_state", report::text_or_null(one.nmt_state), Show::json},
          {"fault", report::text_or_null(one.fault), Show::json},
          {"alarms", texts(one.alarms), Show::json},
          {"remarks", report::text_or_null(joined_or(remarks, "")), Show::text},
          {"remarks", texts(remarks), Show::json},
          {"assumed", one.assumed, Show::json}};
}

Result<Value> run_watchdog(Context& context, const Arguments&) {
  report::List out;
  for (const auto& one : motion::read_watchdogs(*context.session, *context.profile, context.nodes)) {
    if (one)
      out.emplace_back(watchdog_record(*one));
    else
      context.errors.push_back(one.error());
  }
  return Value(std::move(out));
}

constexpr Example kWatchdogExamples[] = {
    {"watchdog -n 1 -d gsd600", "what the drive does when the cable is pulled"},
};

}  // namespace

extern const Command kWatchdog;
const Command kWatchdog{
    .path = "watchdog",
    .summary = "Show what drives do when their master disappears",
    .details =
        "Reads what each drive watches (heartbeats by 1016h, life guarding by 100Ch and 100Dh), what it does "
        "then (6007h, 1029h), and says what its family's data knows of it: an alarm for lost communication, a "
        "parameter that masks it. What no manual states is marked as assumed. On EtherCAT the sync manager "
        "watchdog does it. It is what is set now: motions arm a watchdog of their own where there is one. "
        "`heartbeat consume` sets one.",
    .parameters = {},
    .examples = kWatchdogExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .family = FamilyCheck::always,
    .run = run_watchdog,
};

}  // namespace servoctl::commands
