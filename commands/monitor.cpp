#include <cmath>
#include <utility>
#include <vector>

#include "base/format.hpp"
#include "base/number.hpp"
#include "can/error_frame.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "command/frame_filter.hpp"
#include "session/can_network.hpp"
#include "session/hearing.hpp"
#include "session/open_bus.hpp"
#include "session/pdo_setup.hpp"
#include "session/process_values.hpp"
#include "show/notice.hpp"
#include "traffic/bus_load.hpp"
#include "traffic/heard_masters.hpp"
#include "traffic/listening.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Value;
using session::NodeEvent;

/// So late frames may be shown: nobody sees the difference, and at full load it halves the work. The queue an
/// ordinary user is given holds those of 25 ms at the least.
constexpr Duration kDelay = std::chrono::milliseconds(10);

constexpr Parameter kMonitorParameters[] = {
    kForOption,
    kServiceOption,
    kObjectOption,
    {.name = "--ask", .help = "first read the PDO mapping of the nodes given by -n", .kind = Kind::flag},
    {.name = "--bitrate",
     .help = "bitrate for the bus load, if the interface does not give it: 500k",
     .kind = Kind::text},
    {.name = "--table", .help = "on a terminal: one row per CAN-ID, updated in place", .kind = Kind::flag},
    {.name = "--raw", .help = "show the frames as well", .kind = Kind::flag},
};

/// `500k`, `1M`, `125000`, in bit/s; 0 when the option was not given.
Result<std::uint32_t> bitrate_option(const Arguments& arguments) {
  if (!arguments.has("--bitrate")) return 0U;
  auto text = arguments.text("--bitrate");
  std::uint64_t factor = 1;
  if (!text.empty() && (text.back() == 'k' || text.back() == 'K')) factor = 1000;
  if (!text.empty() && (text.back() == 'M' || text.back() == 'm')) factor = 1'000'000;
  if (factor > 1) text.remove_suffix(1);
  const auto number = parse_digits(text, 10);
  if (!number || *number == 0 || *number > 1'000'000 || *number * factor > 1'000'000)
    return fail(Errc::usage, message("'{}' is not a bitrate", as_it_is(arguments.text("--bitrate"))),
                "write 125k, 250k, 500k or 1M; CANopen has at most 1 Mbit/s");
  return static_cast<std::uint32_t>(*number * factor);
}

/// Puts the PDOs of the nodes into the book as the drives tell them.
Result<void> ask_mappings(Context& context, show::PdoBook& book) {
  if (context.nodes.empty() || context.nodes.front() == 0)
    return fail(Errc::usage, "--ask needs a list of nodes", "add -n 1 or a list");
  auto answers = session::read_pdo_values(*context.session, context.profile, context.nodes);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i]) return fail(answers[i].error());
    book.set(context.nodes[i], std::move(*answers[i]));
  }
  return {};
}

/// Whether the node stopped telling that it lives.
bool is_loss(const NodeEvent& event) {
  const auto* gone = std::get_if<NodeEvent::Gone>(&event.what);
  return gone != nullptr && gone->sign == NodeEvent::Gone::Sign::heartbeat;
}

class Monitor {
 public:
  /// `view`: null where frames are lines.
  Monitor(Context& context, traffic::FrameLog& log, std::uint32_t bitrate, show::LiveView* view)
      : context_(&context),
        log_(&log),
        view_(view),
        load_(bitrate, context.session->now()),
        fd_before_(context.session->can()->bus().fd_frames()),
        begin_(context.session->now()) {}

  /// The PDOs of the nodes were read; `lifetimes`, one of each, began before that.
  void ask_again(std::vector<session::Lifetime> lifetimes) { lifetimes_ = std::move(lifetimes); }

  Result<void> run(std::optional<Duration> length) {
    traffic::Listener listener;
    listener.on_frame = [this](const can::Frame& frame, TimePoint time) { add(frame, time); };
    listener.on_pause = [this] {
      take_alarms();
      renew_mappings();
      log_->flush();
      if (view_ != nullptr) view_->refresh(context_->session->now());
    };
    listener.is_over = [this] { return view_ != nullptr && view_->is_over(); };
    listener.on_bus = [this](bool back, std::string_view line) { tell_bus(back, line); };
    context_->session->can()->bus().gather(kDelay);
    const auto ended = traffic::listen(*context_->session, length, listener);
    context_->session->can()->bus().gather(Duration::zero());
    return ended;
  }

  report::Record summary() const {
    const auto now = context_->session->now();
    const auto fd_frames = context_->session->can()->bus().fd_frames() - fd_before_;
    const auto seconds = std::chrono::duration<double>(now - begin_).count();
    const auto percent = [](std::optional<double> load) {
      return load ? Value(std::round(*load * 10) / 10) : Value();
    };
    report::Table services;
    services.columns = {{"service"}, {"frames"}};
    for (const auto& [service, count] : log_->services()) services.rows.push_back({service, count});
    return {
        {"frames", log_->count()},
        {"fd_frames", fd_frames, fd_frames > 0 ? report::Show::everywhere : report::Show::json,
         "CAN FD frames, not read"},
        {"seconds", std::round(seconds * 1000) / 1000},
        {"frames_per_second",
         seconds > 0 ? Value(std::round(static_cast<double>(log_->count()) / seconds)) : Value(),
         report::Show::everywhere, "frames a second"},
        {"load", percent(load_.mean(now)), report::Show::everywhere, "bus load (%)"},
        {"peak_load", percent(load_.peak()), report::Show::everywhere, "peak in 100 ms (%)"},
        {"heartbeats_lost", lost_, report::Show::everywhere, "heartbeats lost"},
        {"wire_errors", wire_errors(), report::Show::json},
        {"wire_errors_text", report::text_or_null(errors_.text()), report::Show::text, "errors on the wire"},
        {"services", std::move(services)}};
  }

 private:
  void add(const can::Frame& frame, TimePoint time) {
    if (const auto error = can::parse_wire_error(frame)) errors_.add(*error);
    load_.add(frame, time);
    masters_.on_frame(frame, time);
    log_->add(time - begin_, context_->session->url(), frame);
  }

  /// With --ask: of nodes that restarted, or were set up anew.
  void renew_mappings() {
    auto& session = *context_->session;
    for (std::size_t i = 0; i < lifetimes_.size(); ++i) {
      if (!lifetimes_[i].is_to_renew()) continue;
      const std::uint8_t nodes[] = {context_->nodes[i]};
      const session::Lifetime lifetime(session, nodes[0]);
      // Frames that arrive meanwhile.
      const session::Hearing hearing(session,
                                     [this](const can::Frame& frame, TimePoint time) { add(frame, time); });
      auto values = session::read_pdo_values(session, context_->profile, nodes);
      if (!values.front()) continue;
      lifetimes_[i] = lifetime;
      log_->decoder().pdos().set(nodes[0], std::move(*values.front()));
      traffic::tell_now(*context_, formatted("node {}: its PDO mapping was read again", nodes[0]));
    }
  }

  /// Everything else the session notices is among the frames.
  void take_alarms() {
    (void)context_->session->can()->take_reports();
    for (const auto& event : context_->session->take_events()) {
      const bool doubled = std::holds_alternative<NodeEvent::Doubled>(event.what);
      if (!doubled && !is_loss(event)) continue;
      if (!doubled) log_->decoder().pdos().forget(event.node);
      if (!doubled && masters_.has_left(event.node, event.time)) continue;
      if (!doubled) ++lost_;
      const auto text = formatted("ALARM {}", show::event_text(event, context_->profile, context_->chinese));
      log_->remark(event.time - begin_, "alarm", event.node, text, doubled ? "doubled" : "heartbeat-lost");
    }
  }

  report::List wire_errors() const {
    report::List out;
    for (std::size_t i = 0; i < can::kWireErrors; ++i) {
      const auto error = static_cast<can::WireError>(i);
      if (errors_.count(error) > 0)
        out.emplace_back(report::Record{{"error", can::text(error)}, {"count", errors_.count(error)}});
    }
    return out;
  }

  /// It is a part of what happened on the bus.
  void tell_bus(bool back, std::string_view line) {
    for (std::uint8_t node = 1; back && node <= 127; ++node) log_->decoder().pdos().forget(node);
    log_->remark(context_->session->now() - begin_, "alarm", {}, formatted("ALARM {}", line),
                 back ? "bus-back" : "bus-lost");
    log_->flush();
    if (view_ != nullptr) view_->refresh(context_->session->now());
  }

  Context* context_;
  traffic::FrameLog* log_;
  show::LiveView* view_;
  traffic::BusLoad load_;
  std::uint64_t fd_before_;  ///< CAN FD frames that had come before.
  TimePoint begin_;
  traffic::HeardMasters masters_;
  can::WireErrors errors_;
  std::size_t lost_ = 0;
  std::vector<session::Lifetime> lifetimes_;  ///< With --ask, of the nodes of the command.
};

Result<Value> run_monitor(Context& context, const Arguments& arguments) {
  auto filter = frame_filter(context, arguments);
  if (!filter) return fail(filter.error());
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  auto bitrate = bitrate_option(arguments);
  if (!bitrate) return fail(bitrate.error());
  if (*bitrate == 0) bitrate = session::bitrate_of(context.session->url()).value_or(0);
  traffic::FrameLog log(context, std::move(*filter), arguments.has("--raw"));
  std::vector<session::Lifetime> lifetimes;
  if (arguments.has("--ask"))
    for (const auto node : context.nodes) lifetimes.emplace_back(*context.session, node);
  if (arguments.has("--ask"))
    if (const auto asked = ask_mappings(context, log.decoder().pdos()); !asked) return fail(asked.error());
  auto view = arguments.has("--table") ? context.open_view(traffic::FrameTable::layout()) : nullptr;
  if (view) log.show_in(*view);
  Monitor monitor(context, log, *bitrate, view.get());
  monitor.ask_again(std::move(lifetimes));
  const auto ended = monitor.run(*length);
  view.reset();
  if (!traffic::has_summary(ended, context.errors)) return fail(ended.error());
  auto summary = monitor.summary();
  summary.push_back(
      {"samples", context.keeps_samples ? Value(log.take_kept()) : Value(), report::Show::json});
  return Value(std::move(summary));
}

constexpr Example kMonitorExamples[] = {
    {"monitor -b can0 -d gsd600", "every frame in words, until Ctrl-C; nothing is sent"},
    {"monitor --table -b can0 -d gsd600", "a row for each CAN-ID, with its period"},
    {"monitor --service emcy --for 10min -b can0 -d gsd600", "emergencies alone, for ten minutes"},
};

}  // namespace

extern const Command kMonitor;
const Command kMonitor{
    .path = "monitor",
    .summary = "Show everything on the bus as it happens, with names and values",
    .details =
        "One line per frame: NMT, SYNC, TIME, EMCY in the family's words, PDOs with the objects they carry, "
        "SDO with names, values and aborts, heartbeats, boot-ups, node guarding; and an ALARM if a node's "
        "heartbeat stops, or two nodes have one number. It sends nothing, except with --ask: then it first reads the PDO mapping of the "
        "nodes given by -n. Otherwise PDOs are decoded by a mapping seen on the bus meanwhile, or by the "
        "family's (-d) factory mapping. With --table a terminal shows one row for each CAN-ID, with its number of "
        "frames, their mean period in ms, and what the last one means (keys: space pauses, s sorts, q quits). A bus that is lost is waited for and told by an ALARM, its return too. At the end (--for, or Ctrl-C) it shows "
        "the number of frames, errors on the wire as far as the driver tells them, and the bus load if the bitrate is known from the interface or --bitrate. `-o jsonl` gives one document per "
        "frame.",
    .parameters = kMonitorParameters,
    .examples = kMonitorExamples,
    .needs = Needs::can,
    .effect = Effect::reads,
    .run = run_monitor,
    .goes_on = true,
    .elsewhere =
        "`status -n all --trace FILE.pcap` writes every frame for Wireshark, as each command with --trace does; what "
        "slaves tell is shown by every command",
};

}  // namespace servoctl::commands
