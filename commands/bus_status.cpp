#include <fmt/format.h>

#include "can/link_change.hpp"
#include "can/socketcan.hpp"
#include "command/command.hpp"
#include "command/interface_option.hpp"
#include "show/link_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Value;

constexpr Parameter kBusStatusParameters[] = {
    {.name = "interface", .help = "CAN interface: can0 (default: all)", .kind = Kind::bus},
};

void tell_right(Context& context) {
  const auto may = can::may_change_links();
  if (may == false)
    context.notices.push_back("this user may not change interfaces (`bus up`, `bus down`): " +
                              can::right_command());
}

Result<Value> run_one(Context& context, const std::string& name) {
  const auto link = can::open_link(name);
  if (!link) return fail(link.error());
  const auto state = (*link)->state();
  if (!state) return fail(state.error());
  tell_right(context);
  return Value(show::link_record(name, *state));
}

Result<Value> run_bus_status(Context& context, const Arguments& arguments) {
  if (arguments.has("interface")) {
    const auto name = interface_argument(arguments);
    return name ? run_one(context, *name) : fail(name.error());
  }
  std::vector<show::NamedLink> links;
  for (auto& name : can::can_interfaces())
    if (auto state = can::link_state(name)) links.push_back({std::move(name), std::move(*state)});
  if (links.empty())
    return fail(
        Errc::bus, "this machine has no CAN interface",
        "plug an adapter in (`doctor` says more); without one: `--bus sim:FAMILY@1`, `--bus local:NAME`, or "
        "`sudo ip link add dev vcan0 type vcan`");
  tell_right(context);
  return Value(show::link_table(links));
}

constexpr Example kBusStatusExamples[] = {
    {"bus status", "all CAN interfaces: up or down, bitrate, error counters"},
    {"bus status can0", "one in full"},
};

}  // namespace

extern const Command kBusStatus;
const Command kBusStatus{
    .path = "bus status",
    .summary = "Show the CAN interfaces: bitrate, state, error counters",
    .details =
        "What the kernel says of all CAN interfaces, or of one in full: up or down, state of the controller "
        "(error-active, error-warning, error-passive, bus-off, stopped), bitrate and sample point, its error counters, "
        "how often it was bus-off and restarted since its driver was loaded, restart-ms, queue length, driver, how "
        "many sockets receive from it, and whether you may change it. Nothing is sent and nothing is changed.",
    .parameters = kBusStatusParameters,
    .examples = kBusStatusExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_bus_status,
};

}  // namespace servoctl::commands
