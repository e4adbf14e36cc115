#include "canopen/sync.hpp"

#include <fmt/format.h>

#include "base/duration.hpp"
#include "base/number.hpp"
#include "commands/command.hpp"
#include "commands/listening.hpp"
#include "commands/rhythm.hpp"

namespace servoctl::commands {
namespace {

using report::Value;

constexpr Duration kDefaultPeriod = std::chrono::milliseconds(10);
constexpr Duration kShortestPeriod = std::chrono::microseconds(200);

constexpr Parameter kStartParameters[] = {
    {.name = "--period", .help = "time from SYNC to SYNC (default 10ms)", .kind = Kind::duration},
    {.name = "--counter",
     .help = "with a counter that runs from 1 to this (2..240, as 1019h says)",
     .kind = Kind::number},
    kForOption,
};

constexpr std::string_view kWarning =
    "Drives take over what RPDOs brought at SYNC: one that is enabled may move.";

Value planned_frame(std::optional<std::uint8_t> counter) {
  return report::Record{{"frame", can::to_string(canopen::sync_frame(counter))}};
}

Result<Value> run_once(Context& context, const Arguments&) {
  if (context.dry_run) return planned_frame({});
  if (const auto sure = context.confirm(fmt::format("Send a SYNC? {}", kWarning)); !sure)
    return tl::unexpected<Error>(sure.error());
  if (const auto sent = context.session->send(canopen::sync_frame()); !sent)
    return tl::unexpected<Error>(sent.error());
  return Value(report::Record{{"sent", 1}});
}

Result<canopen::SyncProducer::Options> options_of(const Arguments& arguments) {
  canopen::SyncProducer::Options out;
  const auto period = duration_option(arguments, "--period");
  if (!period) return tl::unexpected<Error>(period.error());
  out.period = period->value_or(kDefaultPeriod);
  if (out.period < kShortestPeriod)
    return fail(Errc::usage, fmt::format("a period of {} is too short", to_string(out.period)),
                "the shortest is 200us; drives want 1ms or more");
  if (!arguments.has("--counter")) return out;
  const auto counter = parse_digits(arguments.text("--counter"), 10);
  if (!counter || *counter < 2 || *counter > 240)
    return fail(Errc::usage, fmt::format("'{}' is no last value of a counter", arguments.text("--counter")),
                "write 2..240 (CiA 301, 1019h)");
  out.last_counter = static_cast<std::uint8_t>(*counter);
  return out;
}

Result<Value> run_start(Context& context, const Arguments& arguments) {
  const auto options = options_of(arguments);
  if (!options) return tl::unexpected<Error>(options.error());
  const auto length = duration_option(arguments, "--for");
  if (!length) return tl::unexpected<Error>(length.error());
  if (context.dry_run)
    return planned_frame(options->last_counter == 0 ? std::nullopt : std::optional<std::uint8_t>(1));
  if (const auto sure =
          context.confirm(fmt::format("Send a SYNC every {}? {}", to_string(options->period), kWarning));
      !sure)
    return tl::unexpected<Error>(sure.error());
  auto& session = *context.session;
  canopen::SyncProducer producer(*options, session.now());
  Rhythm rhythm;
  Listener listener;
  listener.next = [&] { return producer.deadline(); };
  listener.on_time = [&](TimePoint now) -> Result<void> {
    producer.on_time(now);
    const auto frame = producer.take_frame();
    if (!frame) return {};
    rhythm.add(session.now());
    return session.send(*frame);
  };
  if (const auto ended = listen(session, *length, listener); !ended)
    return tl::unexpected<Error>(ended.error());
  report::Table table;
  table.columns = Rhythm::columns();
  table.columns.push_back({"missed"});
  auto row = rhythm.cells();
  row.emplace_back(producer.missed());
  table.rows.push_back(std::move(row));
  return Value(std::move(table));
}

}  // namespace

extern const Command kSyncOnce;
const Command kSyncOnce{
    .path = "sync once",
    .summary = "Send one SYNC; asks first",
    .details =
        "Synchronous RPDOs that came before take effect, synchronous TPDOs are sent. It asks, because a "
        "drive "
        "may move.",
    .parameters = {},
    .needs = Needs::bus,
    .effect = Effect::moves,
    .run = run_once,
};

extern const Command kSyncStart;
const Command kSyncStart{
    .path = "sync start",
    .summary = "Produce SYNC in a steady period until Ctrl-C; asks first",
    .details =
        "Ends with --for or Ctrl-C (there is nothing left running to be stopped), and then tells the periods "
        "that were "
        "measured: mean, shortest, longest, standard deviation, and how many SYNCs were missed because the "
        "computer "
        "was late. There must be no other producer of SYNC on the bus.",
    .parameters = kStartParameters,
    .needs = Needs::bus,
    .effect = Effect::moves,
    .run = run_start,
};

}  // namespace servoctl::commands
