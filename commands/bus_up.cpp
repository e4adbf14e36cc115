#include <fmt/format.h>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "can/link_change.hpp"
#include "command/command.hpp"
#include "command/interface_option.hpp"
#include "drive/bitrate.hpp"
#include "session/bus_setup.hpp"
#include "show/link_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Value;

constexpr Parameter kBusUpParameters[] = {
    kInterface,
    {.name = "--bitrate", .help = "bitrate of the drives: 125k, 250k, 500k, 1M", .kind = Kind::text},
    {.name = "--sample-point", .help = "where in a bit it is sampled: 0.8 or 80%", .kind = Kind::text},
    {.name = "--restart-ms", .help = "come back so long after a bus-off; 0: never", .kind = Kind::number},
    {.name = "--txqueuelen", .help = "frames that may wait to be sent: 1000", .kind = Kind::number},
};

Result<std::optional<std::uint16_t>> sample_point_of(const Arguments& arguments) {
  if (!arguments.has("--sample-point")) return std::optional<std::uint16_t>();
  auto text = trim(arguments.text("--sample-point"));
  const bool per_cent = text.ends_with('%');
  if (per_cent) text.remove_suffix(1);
  const auto number = parse_real(trim(text));
  const double thousandths = number ? *number * (per_cent ? 10 : 1000) : 0;
  if (!number || !(thousandths >= 500 && thousandths < 1000))
    return fail(Errc::usage,
                message("'{}' is not a sample point", as_it_is(arguments.text("--sample-point"))),
                "write 0.8 or 80%; CiA 301 recommends 0.875");
  return std::optional(static_cast<std::uint16_t>(std::floor(thousandths + 0.5)));
}

Result<session::BusWish> bus_wish(const Arguments& arguments) {
  session::BusWish out;
  if (arguments.has("--bitrate")) {
    const auto bitrate = drive::parse_bitrate(arguments.text("--bitrate"));
    if (!bitrate) return fail(bitrate.error());
    out.bitrate = *bitrate;
  }
  const auto sample_point = sample_point_of(arguments);
  if (!sample_point) return fail(sample_point.error());
  out.sample_point = *sample_point;
  const auto restart = number_option(arguments, "--restart-ms", 0, 3'600'000);
  if (!restart) return fail(restart.error());
  out.restart_ms = *restart;
  const auto queue = number_option(arguments, "--txqueuelen", 1, 100'000);
  if (!queue) return fail(queue.error());
  out.queue_length = *queue;
  return out;
}

std::string question_bus_up(const std::string& name, const session::BusPlan& plan) {
  auto out = formatted("Take {} down and up again? It is up with {}. Its bus stands still for that time",
                       name, fmt::join(plan.differs, ", "));
  if (const auto who = who_receives(name); !who.empty()) out += "; " + who;
  return out + ".";
}

Value planned_bus_up(const std::string& name, const session::BusPlan& plan) {
  report::Table table;
  table.columns = {{"command"}};
  for (const auto& step : plan.steps) table.rows.push_back({can::ip_command(name, step)});
  return Value(std::move(table));
}

Result<Value> run_bus_up(Context& context, const Arguments& arguments) {
  const auto name = interface_argument(arguments);
  if (!name) return fail(name.error());
  const auto wish = bus_wish(arguments);
  if (!wish) return fail(wish.error());
  const auto link = can::open_link(*name);
  if (!link) return fail(link.error());
  const auto before = (*link)->state();
  if (!before) return fail(before.error());
  const auto plan = session::plan_bus_up(*name, *before, *wish);
  if (!plan) return fail(plan.error());
  if (context.dry_run) return planned_bus_up(*name, *plan);
  if (plan->steps.empty()) {
    context.notices.push_back(
        message("{} is up with these settings already; nothing was changed", as_it_is(*name)));
    return Value(show::link_record(*name, *before));
  }
  if (plan->stops_bus) {
    if (const auto held = hold_energised(context, *name); !held) return fail(held.error());
    if (const auto agreed = context.confirm(question_bus_up(*name, *plan)); !agreed)
      return fail(agreed.error());
  }
  if (const auto done = session::set_up(**link, *before, *plan); !done) return fail(done.error());
  const auto after = (*link)->state();
  if (!after) return fail(after.error());
  for (const auto& phrase : session::rounded(*after, *wish))
    context.notices.push_back(message("{}: {}", as_it_is(*name), phrase));
  return Value(show::link_record(*name, *after));
}

Result<void> check_bus_up(Context&, const Arguments& arguments) {
  if (const auto name = interface_argument(arguments); !name) return fail(name.error());
  const auto wish = bus_wish(arguments);
  return wish ? Result<void>() : fail(wish.error());
}

constexpr Example kBusUpExamples[] = {
    {"bus up can0 --bitrate 500k", "up, with the bitrate of the drives"},
    {"bus up can0 --bitrate 1M --restart-ms 100 --txqueuelen 1000",
     "with a longer queue, and back by itself 100 ms after a bus-off"},
    {"bus up can0 --bitrate 500k --dry-run", "only show the commands of iproute2 that do it"},
};

}  // namespace

extern const Command kBusUp;
const Command kBusUp{
    .path = "bus up",
    .summary = "Bring a CAN interface up with a bitrate",
    .details =
        "Sets bitrate, sample point, restart time and queue length through the kernel (rtnetlink) and "
        "brings the interface up; what is not named stays as it is, and where no sample point is named the "
        "kernel chooses one. An interface that is up already as wanted is left alone. With other settings "
        "it has to be taken down for it, so that its bus stands still: that asks first, and needs --yes in "
        "a script; one that is bus-off is taken down and up without a question. If the kernel refuses, it "
        "is put back to what it was. --dry-run shows the commands of iproute2 that do the same. vcan and "
        "vxcan have no bitrate: `bus up vcan0`. It needs the right CAP_NET_ADMIN; `bus status` says "
        "whether you have it.",
    .parameters = kBusUpParameters,
    .examples = kBusUpExamples,
    .needs = Needs::nothing,
    .effect = Effect::links,
    .family = FamilyCheck::never,
    .run = run_bus_up,
    .check = check_bus_up,
};

}  // namespace servoctl::commands
