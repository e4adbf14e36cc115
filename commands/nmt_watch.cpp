#include <fmt/format.h>
#include <algorithm>
#include <numeric>

#include "base/number.hpp"
#include "canopen/cob_id.hpp"
#include "commands/command.hpp"
#include "commands/listening.hpp"
#include "commands/notice.hpp"
#include "drive/standard_objects.hpp"
#include "session/scan.hpp"

namespace servoctl::commands {
namespace {

using canopen::NodeEvent;
using report::Show;
using report::Value;

constexpr Duration kSlice = std::chrono::milliseconds(100);

constexpr Parameter kParameters[] = {
    kForOption,
    {.name = "--guard", .help = "ask by node guarding, once in this time", .kind = Kind::duration},
    {.name = "--life",
     .help = "lost after so many guard times without answer (default 3)",
     .kind = Kind::number},
};

struct Plan {
  std::optional<Duration> length;
  std::optional<Duration> guard_time;
  std::uint32_t life_factor = 3;
};

Result<Plan> plan_of(const Arguments& arguments) {
  Plan plan;
  const auto length = duration_option(arguments, "--for");
  if (!length) return tl::unexpected<Error>(length.error());
  plan.length = *length;
  const auto guard_time = duration_option(arguments, "--guard");
  if (!guard_time) return tl::unexpected<Error>(guard_time.error());
  plan.guard_time = *guard_time;
  if (!arguments.has("--life")) return plan;
  if (!plan.guard_time)
    return fail(Errc::usage, "--life is of node guarding: without --guard nothing is guarded",
                "--guard 100ms --life 3");
  const auto life = parse_digits(arguments.text("--life"), 10);
  if (!life || *life < 1 || *life > 255)
    return fail(Errc::usage, fmt::format("'{}' is no life time factor", arguments.text("--life")),
                "write 1..255");
  plan.life_factor = static_cast<std::uint32_t>(*life);
  return plan;
}

/// `all` means those that are there now.
Result<std::vector<std::uint8_t>> nodes_of(Context& context) {
  if (context.nodes.front() != 0) return context.nodes;
  std::vector<std::uint8_t> every(canopen::kLastNode);
  std::iota(every.begin(), every.end(), canopen::kFirstNode);
  const auto found = session::scan(*context.session, every);
  if (!found) return tl::unexpected<Error>(found.error());
  std::vector<std::uint8_t> out;
  for (const auto& identity : *found) out.push_back(identity.node);
  if (out.empty())
    return fail(Errc::timeout, "no node answered", "check power, cable, termination and bitrate");
  return out;
}

/// A node without heartbeat would be silent whatever happens to it.
void complain_of_silent_nodes(Context& context, std::span<const std::uint8_t> nodes) {
  std::vector<session::SdoRequest> requests;
  for (const auto node : nodes)
    requests.push_back({.node = node, .object = objects::kProducerHeartbeat, .size = 2});
  const auto answers = context.session->transfer(requests);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (answers[i] && (load_le(*answers[i]) & 0xFFFFU) != 0) continue;
    Error error;
    error.code = Errc::negative;
    error.node = nodes[i];
    error.message = fmt::format("node {}: sends no heartbeat", nodes[i]);
    error.hint = fmt::format("`write 0x1017 500 -n {}` switches it on; or ask it by --guard 1s", nodes[i]);
    context.errors.push_back(std::move(error));
  }
}

std::string_view event_name(const NodeEvent& event) {
  constexpr std::string_view kNames[] = {"boot-up",       "state",         "heartbeat-lost", "emergency",
                                         "guarding-lost", "guarding-back", "doubled"};
  static_assert(std::size(kNames) == std::variant_size_v<decltype(event.what)>);
  return kNames[event.what.index()];
}

/// What happened to the nodes while they were watched.
class Log {
 public:
  Log(Context& context, std::span<const std::uint8_t> nodes)
      : context_(&context), nodes_(nodes), begin_(context.session->now()) {
    for (const auto node : nodes) boots_before_[node] = context.session->watch().boots(node);
  }

  void take_events() {
    for (const auto& event : context_->session->take_events()) {
      if (std::find(nodes_.begin(), nodes_.end(), event.node) == nodes_.end()) continue;
      const bool lost = std::holds_alternative<NodeEvent::HeartbeatLost>(event.what) ||
                        std::holds_alternative<NodeEvent::GuardingLost>(event.what);
      lost_[event.node] += lost;
      gone_[event.node] = lost;
      emergencies_[event.node] += std::holds_alternative<canopen::Emergency>(event.what) ? event.times : 0;
      const std::chrono::duration<double> time = event.time - begin_;
      const auto text = notice_text(event, context_->profile, context_->chinese);
      report::Record record{
          {"time", time.count()}, {"node", event.node}, {"event", event_name(event)}, {"text", text}};
      context_->emit(record, fmt::format("{:10.3f}  {}", time.count(), text));
      if (context_->keeps_samples) events_.emplace_back(std::move(record));
    }
  }

  /// Errors of nodes that were lost or never heard go to the context.
  Value summary() {
    report::Table table;
    table.columns = {{"node"},
                     {"alive"},
                     {"state"},
                     {"period_ms", "period (ms)"},
                     {"boots"},
                     {"lost"},
                     {"emergencies", "EMCY"}};
    const auto& watch = context_->session->watch();
    for (const auto node : nodes_) {
      const auto state = watch.state(node);
      const auto period = std::chrono::duration_cast<std::chrono::milliseconds>(watch.period(node)).count();
      table.rows.push_back({node, state.has_value() && !gone_[node],
                            state ? Value(canopen::name(*state)) : Value(),
                            period == 0 ? Value() : Value(period), watch.boots(node) - boots_before_[node],
                            lost_[node], emergencies_[node]});
      if (lost_[node] > 0 || !state) complain(node, state.has_value());
    }
    return report::Record{{"nodes", std::move(table)}, {"events", std::move(events_), Show::json}};
  }

 private:
  void complain(std::uint8_t node, bool heard) {
    Error error;
    error.code = Errc::negative;
    error.node = node;
    error.message =
        heard ? fmt::format("node {}: was lost {} time{}", node, lost_[node], lost_[node] == 1 ? "" : "s")
              : fmt::format("node {}: was never heard", node);
    context_->errors.push_back(std::move(error));
  }

  Context* context_;
  std::span<const std::uint8_t> nodes_;
  TimePoint begin_;
  std::array<std::uint32_t, 128> boots_before_{};
  std::array<std::uint32_t, 128> lost_{};
  std::array<bool, 128> gone_{};  ///< Nothing has come since it was lost.
  std::array<std::uint32_t, 128> emergencies_{};
  report::List events_;
};

/// Guarding is asked, and a drive that was guarded once may take its end for an error.
report::Table guarding_frames(std::span<const std::uint8_t> nodes) {
  report::Table table;
  table.columns = {{"node"}, {"frame"}};
  for (const auto node : nodes) {
    canopen::NodeGuard guard;
    guard.start(node, {}, TimePoint{});
    guard.on_time(TimePoint{});
    const auto frame = guard.take_frame();
    table.rows.push_back({node, frame ? can::to_string(*frame) : std::string()});
  }
  return table;
}

Result<Value> run(Context& context, const Arguments& arguments) {
  const auto plan = plan_of(arguments);
  if (!plan) return tl::unexpected<Error>(plan.error());
  const auto nodes = nodes_of(context);
  if (!nodes) return tl::unexpected<Error>(nodes.error());
  auto& session = *context.session;
  if (plan->guard_time && context.dry_run) return Value(guarding_frames(*nodes));
  if (plan->guard_time) {
    for (const auto node : *nodes) session.guard(node, {*plan->guard_time, plan->life_factor});
  } else {
    complain_of_silent_nodes(context, *nodes);
  }
  Log log(context, *nodes);
  const auto end = plan->length ? session.now() + *plan->length : kNever;
  Result<bool> waited = false;
  while (waited && session.now() < end) {
    waited = session.wait([] { return false; }, std::min(end, session.now() + kSlice));
    log.take_events();
  }
  session.stop_guarding();
  if (!waited && waited.error().code != Errc::interrupted) return tl::unexpected<Error>(waited.error());
  return log.summary();
}

}  // namespace

extern const Command kNmtWatch;
const Command kNmtWatch{
    .path = "nmt watch",
    .summary = "Watch whether nodes are alive: heartbeat or node guarding",
    .details =
        "Tells boot-ups, changes of state, emergencies, and nodes that are lost or back, as they happen; at "
        "the end "
        "(--for, or Ctrl-C) what became of each node. A lost node is one that was silent for three of its "
        "heartbeat "
        "periods, or with --guard did not answer in its life time. Guarding sends frames that start a "
        "drive's "
        "own watch over its master: --read-only refuses it. Exit code 1 when a node was lost, never "
        "heard, or "
        "sends no heartbeat. Do not guard nodes that send heartbeats: CiA 301 allows one of the two.",
    .parameters = kParameters,
    .needs = Needs::node,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .reads_without = "--guard",
    .run = run,
};

}  // namespace servoctl::commands
