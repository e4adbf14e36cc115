
#include "base/format.hpp"
#include "can/link_change.hpp"
#include "command/command.hpp"
#include "command/interface_option.hpp"
#include "show/link_table.hpp"

namespace servoctl::commands {
namespace {

using namespace command;
using report::Value;

constexpr Parameter kBusDownParameters[] = {kInterface};

Result<Value> run_bus_down(Context& context, const Arguments& arguments) {
  const auto name = interface_argument(arguments);
  if (!name) return fail(name.error());
  const auto link = can::open_link(*name);
  if (!link) return fail(link.error());
  const auto before = (*link)->state();
  if (!before) return fail(before.error());
  const can::LinkChange down{.up = false};
  if (context.dry_run) {
    report::Table table;
    table.columns = {{"command"}};
    if (before->up) table.rows.push_back({can::ip_command(*name, down)});
    return Value(std::move(table));
  }
  if (!before->up) {
    context.notices.push_back(message("{} is down already; nothing was changed", as_it_is(*name)));
    return Value(show::link_record(*name, *before));
  }
  if (const auto held = hold_energised(context, *name); !held) return fail(held.error());
  if (const auto who = who_receives(*name); !who.empty())
    if (const auto agreed = context.confirm(formatted(
            "Take {} down? {}, and what drives do without their master is their own affair.", *name, who));
        !agreed)
      return fail(agreed.error());
  if (const auto done = (*link)->change(down); !done) return fail(done.error());
  const auto after = (*link)->state();
  if (!after) return fail(after.error());
  return Value(show::link_record(*name, *after));
}

Result<void> check_bus_down(Context&, const Arguments& arguments) {
  const auto name = interface_argument(arguments);
  return name ? Result<void>() : fail(name.error());
}

constexpr Example kBusDownExamples[] = {
    {"bus down can0", "take it down; asks where somebody receives from it"},
};

}  // namespace

extern const Command kBusDown;
const Command kBusDown{
    .path = "bus down",
    .summary = "Take a CAN interface down",
    .details =
        "Its settings stay with it for the next `bus up`. When a program of this machine receives from the interface "
        "(by the kernel's lists; one that only sends is not in them), it says so and asks first, and needs --yes in a "
        "script. Refused while a drive is energised that this prompt or batch file enabled over it. It needs the right "
        "CAP_NET_ADMIN; `bus status` says whether you have it.",
    .parameters = kBusDownParameters,
    .examples = kBusDownExamples,
    .needs = Needs::nothing,
    .effect = Effect::links,
    .family = FamilyCheck::never,
    .run = run_bus_down,
    .check = check_bus_down,
};

}  // namespace servoctl::commands
