#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "canopen/sdo_abort.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "drive/standard_objects.hpp"
#include "session/bus_return.hpp"
#include "session/can_network.hpp"
#include "session/scan.hpp"
#include "session/stretch.hpp"
#include "show/notice.hpp"
#include "traffic/listening.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Show;
using report::Value;
using session::NodeEvent;

constexpr Duration kSlice = std::chrono::milliseconds(100);

constexpr Parameter kNmtWatchParameters[] = {
    kForOption,
    {.name = "--guard", .help = "use node guarding, with this guard time", .kind = Kind::duration},
    {.name = "--life",
     .help = "life time factor: guard times without answer (default 3)",
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
  if (!length) return fail(length.error());
  plan.length = *length;
  const auto guard_time = duration_option(arguments, "--guard");
  if (!guard_time) return fail(guard_time.error());
  plan.guard_time = *guard_time;
  if (!arguments.has("--life")) return plan;
  if (!plan.guard_time)
    return fail(Errc::usage, "--life is for node guarding only: it needs --guard", "--guard 100ms --life 3");
  const auto life = parse_digits(arguments.text("--life"), 10);
  if (!life || *life < 1 || *life > 255)
    return fail(Errc::usage, message("'{}' is not a life time factor", as_it_is(arguments.text("--life"))),
                "write 1..255");
  plan.life_factor = static_cast<std::uint32_t>(*life);
  return plan;
}

/// What the nodes say of their heartbeat (1017h); one that is stopped or away says nothing. The session
/// learns from their 1014h under which CAN-ID emergencies come.
std::vector<Result<Bytes>> ask_for_heartbeats(session::Session& session,
                                              std::span<const std::uint8_t> nodes) {
  std::vector<session::SdoRequest> requests;
  for (const auto node : nodes)
    requests.push_back({.node = node, .object = objects::kProducerHeartbeat, .size = 2});
  for (const auto node : nodes)
    requests.push_back({.node = node, .object = objects::kEmergencyCobId, .size = 4});
  auto answers = session.transfer(requests);
  answers.resize(nodes.size(), Result<Bytes>(Bytes{}));
  return answers;
}

std::string_view event_name(const NodeEvent& event) {
  const auto* gone = std::get_if<NodeEvent::Gone>(&event.what);
  if (gone != nullptr && gone->sign != NodeEvent::Gone::Sign::heartbeat) return "guarding-lost";
  constexpr std::string_view kNames[] = {"boot-up",       "state",   "heartbeat-lost", "emergency",
                                         "guarding-back", "doubled", "state-error"};
  static_assert(std::size(kNames) == std::variant_size_v<decltype(event.what)>);
  return kNames[event.what.index()];
}

/// What happened to the nodes while they were watched.
class Log {
 public:
  Log(Context& context, std::span<const std::uint8_t> nodes)
      : context_(&context), begin_(context.session->now()) {
    const auto& watch = context.session->can()->watch();
    for (const auto node : nodes)
      rows_.push_back(
          {.node = node, .boots = watch.boots(node), .heartbeats = watch.heartbeats(node), .told = {}});
  }

  /// What the nodes said when they were asked for their heartbeat, in their order.
  void told(std::vector<Result<Bytes>> answers) {
    for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i].told = std::move(answers[i]);
  }

  void take_events() {
    for (const auto& event : context_->session->take_events()) {
      const auto row =
          std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.node == event.node; });
      if (row == rows_.end()) continue;
      const bool lost = std::holds_alternative<NodeEvent::Gone>(event.what);
      row->lost += lost;
      row->gone = lost;
      row->emergencies += std::holds_alternative<canopen::Emergency>(event.what) ? event.times : 0;
      const std::chrono::duration<double> time = event.time - begin_;
      const auto text = show::notice_text(event, context_->profile, context_->chinese).text();
      report::Record record{
          {"time", time.count()}, {"node", event.node}, {"event", event_name(event)}, {"text", text}};
      context_->emit(record, formatted("{:10.3f}  {}", time.count(), text));
      if (context_->keeps_samples) events_.emplace_back(std::move(record));
    }
  }

  /// Errors of nodes that were lost, never heard, or tell nothing regularly go to the context. `bus_lost`:
  /// the bus is, and of no node is known how it is.
  Value summary(bool bus_lost) {
    report::Table table;
    table.columns = {{"node"},
                     {"alive"},
                     {"state"},
                     {"period_ms", "period (ms)"},
                     {"boots"},
                     {"lost"},
                     {"emergencies", "EMCY"}};
    const auto& watch = context_->session->can()->watch();
    for (const auto& row : rows_) {
      const auto state = watch.state(row.node);
      const auto period =
          std::chrono::duration_cast<std::chrono::milliseconds>(watch.period(row.node)).count();
      table.rows.push_back({row.node, bus_lost ? Value() : alive(row),
                            state ? Value(canopen::name(*state)) : Value(),
                            period == 0 ? Value() : Value(period), watch.boots(row.node) - row.boots,
                            row.lost, row.emergencies});
      if (!bus_lost) complain(row);
    }
    return report::Record{{"nodes", std::move(table)}, {"events", std::move(events_), Show::json}};
  }

 private:
  struct Row {
    std::uint8_t node = 0;
    std::uint32_t boots = 0;       ///< When the watch began.
    std::uint32_t heartbeats = 0;  ///< When the watch began.
    std::uint32_t lost = 0;
    bool gone = false;  ///< Nothing has come since it was lost.
    std::uint32_t emergencies = 0;
    std::optional<Result<Bytes>> told;  ///< Its 1017h, if it was asked.
  };

  /// Heartbeats, or answers to node guarding.
  bool regular(const Row& row) const {
    return context_->session->can()->watch().heartbeats(row.node) > row.heartbeats;
  }
  bool answered(const Row& row) const {
    return row.told && (*row.told || row.told->error().code == Errc::sdo_abort);
  }
  bool heard(const Row& row) const {
    return context_->session->can()->watch().boots(row.node) > row.boots || row.emergencies > 0;
  }
  /// Before the watch, or in it. Guarding is lost as well where nobody ever answered it, and a state is
  /// forgotten with the heartbeat.
  bool was_there(const Row& row) const {
    const auto& watch = context_->session->can()->watch();
    return watch.heartbeats(row.node) > 0 || watch.boots(row.node) > 0;
  }
  /// Of a node that was there once and tells nothing regularly, nobody knows.
  Value alive(const Row& row) const {
    if (row.gone) return false;
    if (regular(row)) return true;
    return answered(row) || heard(row) ? Value() : Value(false);
  }

  void complain(const Row& row) {
    Message what;
    Message hint = "try --guard 1s";
    if (row.lost > 0 && was_there(row)) {
      what = message("was lost {} time{}", row.lost, plural(row.lost));
      hint = {};
    } else if (regular(row)) {
      return;
    } else if (row.told && *row.told) {
      const auto period = load_le(**row.told) & 0xFFFFU;
      what = period == 0 ? Message("sends no heartbeat")
                         : message("no heartbeat came, although 1017h is {} ms", period);
      if (period == 0)
        hint = message("`heartbeat set 500ms -n {}` switches it on; or {}", node_name(row.node), hint);
    } else if (answered(row)) {
      const auto code = row.told->error().abort_code;
      what = code == canopen::sdo_abort::kNoObject || code == canopen::sdo_abort::kNoSubIndex
                 ? Message("no heartbeat came, and it has no 1017h to enable one")
                 : "no heartbeat came, and 1017h could not be read: " + row.told->error().message;
    } else if (heard(row)) {
      what = "no heartbeat and no SDO answer; only boot-up or emergency messages were received";
    } else {
      what = "does not answer and sent nothing";
      hint = "is it powered and connected, and is this its node-ID? `scan` shows who answers";
    }
    context_->errors.push_back(drive_error(Errc::negative, row.node, what, std::move(hint)));
  }

  Context* context_;
  TimePoint begin_;
  std::vector<Row> rows_;
  report::List events_;
};

/// From now on, or anew behind a bus that was lost.
void guard(session::Session& session, std::span<const std::uint8_t> nodes, const Plan& plan) {
  if (!plan.guard_time) return;
  for (const auto node : nodes) session.can()->guard(node, {*plan.guard_time, plan.life_factor});
}

/// Until its end, or Ctrl-C, which is no error.
Result<void> watch(session::Session& session, std::span<const std::uint8_t> nodes, const Plan& plan,
                   Log& log) {
  const session::Stretch stretch(session, plan.length ? session.now() + *plan.length : kNever);
  session::BusReturn bus(session, session::BusReturn::to_people(session));
  while (session.now() < stretch.end()) {
    const auto waited = session.wait([] { return false; }, std::min(stretch.end(), session.now() + kSlice));
    log.take_events();
    if (waited) continue;
    if (waited.error().code == Errc::interrupted) return {};
    const auto back = waited.error().code == Errc::bus ? bus.wait(waited.error(), stretch.end())
                                                       : Result<void>(fail(waited.error()));
    if (!back) return back;
    guard(session, nodes, plan);
  }
  return {};
}

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

Result<Value> run_nmt_watch(Context& context, const Arguments& arguments) {
  const auto plan = plan_of(arguments);
  if (!plan) return fail(plan.error());
  // `all` means those that are there now.
  const auto nodes = context.nodes.front() != 0 ? Result<std::vector<std::uint8_t>>(context.nodes)
                                                : session::nodes_present(*context.session);
  if (!nodes) return fail(nodes.error());
  auto& session = *context.session;
  if (plan->guard_time && context.dry_run) return Value(guarding_frames(*nodes));
  Log log(context, *nodes);
  if (plan->guard_time)
    guard(session, *nodes, *plan);
  else
    log.told(ask_for_heartbeats(session, *nodes));
  const auto watched = watch(session, *nodes, *plan, log);
  session.can()->stop_guarding();
  if (!traffic::has_summary(watched, context.errors)) return fail(watched.error());
  return log.summary(!watched);
}

constexpr Example kNmtWatchExamples[] = {
    {"nmt watch -n 1,2", "by their heartbeats, until Ctrl-C"},
    {"nmt watch -n 1 --for 10min", "for ten minutes; exit code 1 if the node was lost"},
    {"nmt watch -n 3 --guard 200ms --life 3", "by node guarding, for a node without heartbeat"},
};

}  // namespace

extern const Command kNmtWatch;
const Command kNmtWatch{
    .path = "nmt watch",
    .summary = "Watch whether nodes are alive: heartbeat or node guarding",
    .details =
        "Reports boot-ups, state changes, emergencies, and nodes lost or back, as they happen; at the end "
        "(--for, or Ctrl-C) a summary of each node. A bus that is lost is waited for until then. A node is lost if it was silent for three heartbeat "
        "periods (at least 100 ms more than one), or with --guard did not answer within its life time. "
        "Emergencies are recognised by the COB-ID in 1014h, which is read first, and by 080h + node-ID; if "
        "the node did not answer, or with --guard, by the latter only. Guarding requests start the drive's "
        "life guarding, so --read-only refuses them. Exit code 1 if a node was lost, never heard, or sends "
        "no heartbeat. Do not guard nodes that send heartbeats: CiA 301 allows only one of the two.",
    .parameters = kNmtWatchParameters,
    .examples = kNmtWatchExamples,
    .needs = Needs::node | Needs::can,
    .effect = Effect::writes,
    .family = FamilyCheck::never,
    .reads_without = "--guard",
    .run = run_nmt_watch,
    .to_all = true,
    .goes_on = true,
    .elsewhere =
        "`status` asks for the AL state; a slave that changes it, is gone or back is told by every command",
};

}  // namespace servoctl::commands
