#include <algorithm>
#include <iterator>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "cabinet/cabinet.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "settings/heartbeats.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;
using session::Supervision;

constexpr std::string_view kOnRing =
    "there are no heartbeats on EtherCAT: `watchdog` shows what a drive does without its master";

constexpr Parameter kSetParameters[] = {
    {.name = "time", .help = "100ms, or off", .kind = Kind::text, .required = true},
    kKeepOption,
    kUnlockOption,
};
constexpr Parameter kConsumeParameters[] = {
    {.name = "watch",
     .help = "NODE=TIME, such as 3=300ms; NODE=off; an axis too",
     .kind = Kind::text,
     .required = true,
     .many = true},
    kKeepOption,
    kUnlockOption,
};

settings::WriteOptions write_options(const Arguments& arguments) {
  return {.read_back = true, .keep = arguments.has("--keep"), .unlock = arguments.has("--unlock")};
}

Result<Value> write(Context& context, const Arguments& arguments, std::span<const settings::Change> changes) {
  const auto options = write_options(arguments);
  if (context.dry_run) return settings::planned_changes(context, changes, options);
  return settings::write_changes(context, changes, options);
}

Result<Duration> time_to_set(const Context& context, const Arguments& arguments) {
  if (context.profile == nullptr && arguments.has("--keep"))
    return fail(Errc::usage, "--keep needs the drive family: each keeps its values in its own way",
                "a line for each family, with -d and --keep; `scan` tells which drive is what");
  return settings::parse_heartbeat_time(arguments.text("time"));
}

Result<void> check_set(Context& context, const Arguments& arguments) {
  const auto time = time_to_set(context, arguments);
  return time ? Result<void>() : fail(time.error());
}

Result<Value> run_set(Context& context, const Arguments& arguments) {
  const auto time = time_to_set(context, arguments);
  if (!time) return fail(time.error());
  std::vector<settings::Change> changes;
  for (const auto node : context.nodes) {
    auto change = settings::producer_change(context, node, *time);
    if (!change) return fail(change.error());
    changes.push_back(std::move(*change));
  }
  return write(context, arguments, changes);
}

/// A word that names an axis as the one that names its node. Those who watch it are on its bus.
Result<std::string> by_node(const Context& context, const std::string& word) {
  const auto equals = std::min(word.find('='), word.size());
  const auto name = word.substr(0, equals);
  const bool of_cabinet = context.session == nullptr || !context.axes.empty();
  if (!of_cabinet || context.front_end == nullptr || parse_integer(name)) return word;
  const auto cabinet = context.front_end->cabinet();
  const auto* axis = cabinet ? (*cabinet)->axis(name) : nullptr;
  if (axis == nullptr) return word;
  for (const auto* watching : context.axes)
    if (watching->bus != axis->bus)
      return fail(
          Errc::usage,
          message("axis {} is on bus {}, {} on bus {}: no heartbeat gets from one to the other",
                  as_it_is(name), as_it_is(axis->bus), as_it_is(watching->name), as_it_is(watching->bus)));
  return formatted("{}{}", axis->node, word.substr(equals));
}

Result<std::vector<settings::HeartbeatWatch>> watches_of(const Context& context, const Arguments& arguments) {
  std::vector<settings::HeartbeatWatch> out;
  for (const auto& word : arguments.all("watch")) {
    const auto of_node = by_node(context, word);
    if (!of_node) return fail(of_node.error());
    const auto watch = settings::parse_heartbeat_watch(*of_node);
    if (!watch) return fail(watch.error());
    out.push_back(*watch);
  }
  return out;
}

Result<void> check_consume(Context& context, const Arguments& arguments) {
  const auto watches = watches_of(context, arguments);
  return watches ? Result<void>() : fail(watches.error());
}

Result<Value> run_consume(Context& context, const Arguments& arguments) {
  const auto watches = watches_of(context, arguments);
  if (!watches) return fail(watches.error());
  std::vector<settings::Change> changes;
  for (const auto node : context.nodes) {
    auto some = settings::consumer_changes(context, node, *watches);
    if (!some) return fail(some.error());
    std::move(some->begin(), some->end(), std::back_inserter(changes));
  }
  return write(context, arguments, changes);
}

std::string time_text(Duration time) {
  return time == Duration::zero() ? std::string("off") : to_string(time);
}

Value time_value(const std::optional<Duration>& time) {
  if (!time) return {};
  return std::chrono::duration_cast<std::chrono::milliseconds>(*time).count();
}

std::string watched_text(const Supervision& one) {
  if (one.entries.empty()) return "none: it has no 1016h";
  std::string out;
  for (const auto& entry : one.entries)
    if (entry.node != 0) append(out, formatted("node {} ({})", entry.node, to_string(entry.time)));
  return out.empty() ? std::string("nobody") : out;
}

Value watched_value(const Supervision& one) {
  if (one.entries.empty()) return {};
  report::List out;
  for (const auto& entry : one.entries)
    if (entry.node != 0)
      out.emplace_back(
          report::Record{{"sub", entry.sub}, {"producer", entry.node}, {"ms", time_value(entry.time)}});
  return Value(std::move(out));
}

std::string life_text(const Supervision& one) {
  if (!one.guard_time || !one.life_time_factor) return "not there";
  return time_text(one.life_time());
}

Result<Value> run_show(Context& context, const Arguments&) {
  const auto found = session::read_supervision(*context.session, *context.profile, context.nodes);
  report::Table table;
  table.columns = {{"node"},
                   {"heartbeat_text", "sends every", Show::text},
                   {"heartbeat_ms", "", Show::json},
                   {"watched_text", "watches", Show::text},
                   {"watched", "", Show::json},
                   {"life_text", "life guarding", Show::text},
                   {"life_time_ms", "", Show::json}};
  for (const auto& one : found) {
    if (!one) context.errors.push_back(one.error());
    if (!one) continue;
    const bool guards = one->guard_time && one->life_time_factor;
    table.rows.push_back({one->node, one->heartbeat ? time_text(*one->heartbeat) : "none: it has no 1017h",
                          time_value(one->heartbeat), watched_text(*one), watched_value(*one),
                          life_text(*one), guards ? time_value(one->life_time()) : Value()});
  }
  table.json_only = table.rows.empty();
  return Value(std::move(table));
}

constexpr Example kHeartbeatSetExamples[] = {
    {"heartbeat set 100ms -n 1 -d gsd600", "send one every 100 ms"},
    {"heartbeat set 100ms -n all", "all drives, of whatever family"},
    {"heartbeat set 500ms --keep -n 1,2 -d gsd600", "kept over power-off"},
};
constexpr Example kHeartbeatConsumeExamples[] = {
    {"heartbeat consume 10=500ms --keep -n 1 -d ts",
     "node 1 notices when node 10 is silent for half a second"},
    {"heartbeat consume 10=off -n 1 -d ts", "no longer"},
};
constexpr Example kHeartbeatShowExamples[] = {
    {"heartbeat show -n 1,2 -d gsd600", "who sends, and who watches whom"},
};

}  // namespace

extern const Command kHeartbeatSet;
const Command kHeartbeatSet{
    .path = "heartbeat set",
    .summary = "Let drives send a heartbeat (1017h)",
    .details =
        "Writes the producer heartbeat time and reads it back; `off` ends it. It is an object of CiA 301, so it "
        "needs no family: `-n all` reaches drives of several. --keep, which does, makes it survive power-off. A drive that "
        "sends heartbeats answers no node guarding (CiA 301).",
    .parameters = kSetParameters,
    .examples = kHeartbeatSetExamples,
    .needs = Needs::node | Needs::can,
    .effect = Effect::writes,
    .run = run_set,
    .check = check_set,
    .elsewhere = kOnRing,
};

extern const Command kHeartbeatConsume;
const Command kHeartbeatConsume{
    .path = "heartbeat consume",
    .summary = "Let drives watch the heartbeat of a node (1016h)",
    .details =
        "Writes the entry of the node, or the first that is free, and reads it back; NODE=off frees it. "
        "The drive watches from the first heartbeat on; what it does when they end is shown by `watchdog`. "
        "A time no longer than the period of the node is refused, and so is a family without 1016h.",
    .parameters = kConsumeParameters,
    .examples = kHeartbeatConsumeExamples,
    .needs = Needs::node | Needs::dictionary | Needs::can,
    .effect = Effect::writes,
    .run = run_consume,
    .check = check_consume,
    .elsewhere = kOnRing,
};

extern const Command kHeartbeatShow;
const Command kHeartbeatShow{
    .path = "heartbeat show",
    .summary = "Show who sends heartbeats, and who watches whom",
    .details = "Reads 1017h, 1016h, and 100Ch and 100Dh (life guarding) of each node.",
    .parameters = {},
    .examples = kHeartbeatShowExamples,
    .needs = Needs::node | Needs::dictionary | Needs::can,
    .effect = Effect::reads,
    .run = run_show,
    .elsewhere = kOnRing,
};

}  // namespace servoctl::commands
