#include "canopen/sync.hpp"
#include "base/format.hpp"

#include "base/duration.hpp"
#include "base/number.hpp"
#include "command/command.hpp"
#include "command/duration_option.hpp"
#include "session/can_network.hpp"
#include "session/hearing.hpp"
#include "traffic/listening.hpp"
#include "traffic/sync_end.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Duration kSyncPeriod = std::chrono::milliseconds(10);
constexpr Duration kShortestPeriod = std::chrono::microseconds(200);

constexpr Parameter kStartParameters[] = {
    {.name = "--period", .help = "SYNC period (default 10ms)", .kind = Kind::duration},
    {.name = "--counter",
     .help = "with a counter from 1 to this overflow value (2..240, see 1019h)",
     .kind = Kind::number},
    kForOption,
};

/// So long is listened for another producer; few have a longer period.
constexpr Duration kListening = std::chrono::milliseconds(200);

constexpr std::string_view kWarning =
    "At SYNC drives apply the RPDOs they received: an enabled drive may move.";

Value planned_frame(std::optional<std::uint8_t> counter) {
  return report::Record{{"frame", can::to_string(canopen::sync_frame(counter))}};
}

/// One more in between would break the rhythm.
Result<void> check_none(const Context& context) {
  const auto* production = context.session->can()->sync();
  if (production == nullptr) return {};
  return fail(Errc::refused,
              message("SYNC is already being produced, every {}", to_string(production->options.period)),
              "`sync stop` ends it");
}

/// Drives would execute at the periods of both.
Result<void> check_quiet(session::Session& session) {
  bool heard = false;
  const session::Hearing hearing(session, [&](const can::Frame& frame, TimePoint) {
    heard = heard || (frame.id == canopen::kSync && !frame.extended && !frame.error);
  });
  const auto waited = session.wait([&] { return heard; }, session.now() + kListening);
  if (!waited) return fail(waited.error());
  if (!*waited) return {};
  return fail(Errc::refused, "another node on this bus already produces SYNC",
              "stop it first: a PLC, another `sync start`, or a drive whose 1005h has bit 30 set");
}

Result<Value> run_once(Context& context, const Arguments&) {
  if (const auto free = check_none(context); !free) return fail(free.error());
  if (context.dry_run) return planned_frame({});
  if (const auto sure = context.confirm(formatted("Send a SYNC? {}", kWarning)); !sure)
    return fail(sure.error());
  if (const auto sent = context.session->can()->send(canopen::sync_frame()); !sent) return fail(sent.error());
  return Value(report::Record{{"sent", 1}});
}

Result<canopen::SyncProducer::Options> sync_options(const Arguments& arguments) {
  canopen::SyncProducer::Options out;
  const auto period = duration_option(arguments, "--period");
  if (!period) return fail(period.error());
  out.period = period->value_or(kSyncPeriod);
  if (out.period < kShortestPeriod)
    return fail(Errc::usage, message("a period of {} is too short", to_string(out.period)),
                "the minimum is 200us; drives need 1ms or more");
  if (!arguments.has("--counter")) return out;
  const auto counter = parse_digits(arguments.text("--counter"), 10);
  if (!counter || *counter < 2 || *counter > 240)
    return fail(Errc::usage,
                message("'{}' is not a counter overflow value", as_it_is(arguments.text("--counter"))),
                "write 2..240 (CiA 301, 1019h)");
  out.last_counter = static_cast<std::uint8_t>(*counter);
  return out;
}

Result<Value> run_start(Context& context, const Arguments& arguments) {
  const auto options = sync_options(arguments);
  if (!options) return fail(options.error());
  const auto length = duration_option(arguments, "--for");
  if (!length) return fail(length.error());
  if (const auto free = check_none(context); !free) return fail(free.error());
  if (context.dry_run) {
    if (const auto quiet = check_quiet(*context.session); !quiet) return fail(quiet.error());
    return planned_frame(options->last_counter == 0 ? std::nullopt : std::optional<std::uint8_t>(1));
  }
  if (const auto sure =
          context.confirm(formatted("Send a SYNC every {}? {}", to_string(options->period), kWarning));
      !sure)
    return fail(sure.error());
  auto& session = *context.session;
  if (const auto quiet = check_quiet(session); !quiet) return fail(quiet.error());
  session.can()->produce_sync(*options);
  if (context.stays_open && !length->has_value()) {
    // The first one goes out now, not when the next line is waited for.
    if (const auto heard = session.listen(); !heard) {
      session.can()->stop_sync();
      return fail(heard.error());
    }
    const std::chrono::duration<double, std::milli> period = options->period;
    return Value(
        report::Record{{"sync", "running"},
                       {"period_ms", period.count(), report::Show::everywhere, "period (ms)"},
                       {"counter", options->last_counter == 0 ? Value() : Value(options->last_counter)}});
  }
  const auto ended = traffic::listen(session, *length, {});
  auto result = traffic::end_sync(session);
  for (auto& warning : result.warnings) context.notices.push_back(std::move(warning));
  if (!ended) return fail(ended.error());
  return Value(std::move(result.table));
}

Result<Value> run_stop(Context& context, const Arguments&) {
  if (context.session->can()->sync() == nullptr)
    return fail(Errc::usage, "no SYNC is produced here",
                "`sync start` in the same prompt or batch file starts it; stop another process with Ctrl-C");
  if (context.dry_run) return Value(report::Record{{"sync", "would be ended"}});
  auto result = traffic::end_sync(*context.session);
  for (auto& warning : result.warnings) context.notices.push_back(std::move(warning));
  return Value(std::move(result.table));
}

constexpr Example kSyncOnceExamples[] = {
    {"sync once", "one SYNC, after a question: a drive may move"},
};
constexpr Example kSyncStartExamples[] = {
    {"sync start --period 4ms", "in the background of the lines that follow; alone until Ctrl-C"},
    {"sync start --period 10ms --for 5s", "for five seconds, with the periods at the end"},
};
constexpr Example kSyncStopExamples[] = {
    {"sync stop", "the one of this prompt or batch file, with its measured periods"},
};

}  // namespace

extern const Command kSyncOnce;
const Command kSyncOnce{
    .path = "sync once",
    .summary = "Send one SYNC; asks first",
    .details =
        "Synchronous RPDOs received before take effect, synchronous TPDOs are sent. Asks first, because a "
        "drive may move.",
    .parameters = {},
    .examples = kSyncOnceExamples,
    .needs = Needs::can,
    .effect = Effect::moves,
    .family = FamilyCheck::never,
    .run = run_once,
    .elsewhere = "process data are exchanged in cycles of their own there: `help state op`",
};

extern const Command kSyncStart;
const Command kSyncStart{
    .path = "sync start",
    .summary = "Produce SYNC at a fixed period; asks first",
    .details =
        "At the prompt, in a pipe and in a batch file it runs in the background of the following lines, until `sync "
        "stop` or the end of input; alone it runs until Ctrl-C, or for the time of --for. At its end it "
        "shows the measured periods: mean, shortest, longest, standard deviation, and how many SYNCs were "
        "missed because the computer was late. There must be no other producer of SYNC on the bus.",
    .parameters = kStartParameters,
    .examples = kSyncStartExamples,
    .needs = Needs::can,
    .effect = Effect::moves,
    .family = FamilyCheck::never,
    .run = run_start,
    .elsewhere = "process data are exchanged in cycles of their own there: `help state op`",
};

extern const Command kSyncStop;
const Command kSyncStop{
    .path = "sync stop",
    .summary = "Stop the SYNC that `sync start` started",
    .details =
        "Shows the measured periods. Drives left energised in a mode that follows SYNC (ip, csp, csv, cst) "
        "are listed: disable them first.",
    .parameters = {},
    .examples = kSyncStopExamples,
    .needs = Needs::can,
    .effect = Effect::none,
    .family = FamilyCheck::never,
    .run = run_stop,
    .elsewhere = "process data are exchanged in cycles of their own there: `help state op`",
};

}  // namespace servoctl::commands
