#include "base/format.hpp"
#include "cabinet/swap.hpp"

#include "base/number.hpp"
#include "canopen/node_id.hpp"
#include "command/cabinet_options.hpp"
#include "command/duration_option.hpp"
#include "command/setting_options.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kCabinetSwapParameters[] = {
    {.name = "axis", .help = "whose drive was replaced", .kind = Kind::text, .required = true},
    {.name = "--from", .help = "node at which the new drive is, often 1", .kind = Kind::number},
    {.name = "--backup", .help = "restore all of this folder of `cabinet backup`", .kind = Kind::file},
    {.name = "--wait",
     .help = "how long to wait for a drive that is to be switched off and on",
     .kind = Kind::duration},
    {.name = "--no-keep", .help = "write working values only; lost at power-off", .kind = Kind::flag},
    kUnlockOption,
    {.name = "--resume",
     .help = "resume what was interrupted while settings were written",
     .kind = Kind::flag},
};

Result<cabinet::SwapOptions> swap_options(const Arguments& arguments) {
  cabinet::SwapOptions out;
  if (arguments.has("--from")) {
    const auto number = parse_integer(arguments.text("--from"));
    const auto node = number ? number->as_unsigned() : std::nullopt;
    if (!node || *node < canopen::kFirstNode || *node > canopen::kLastNode)
      return fail(Errc::usage, message("'{}' is not a node-ID", as_it_is(arguments.text("--from"))),
                  "node-IDs are 1 to 127");
    out.from = static_cast<std::uint8_t>(*node);
  }
  const auto patience = duration_option(arguments, "--wait");
  if (!patience) return fail(patience.error());
  out.backup = arguments.text("--backup");
  out.address = {.unlock = arguments.has("--unlock"), .patience = patience->value_or(Duration::zero())};
  out.apply = {.choice = {.unlisted = false},
               .keep = !arguments.has("--no-keep"),
               .unlock = arguments.has("--unlock"),
               .resume = arguments.has("--resume")};
  return out;
}

Result<report::Value> run_cabinet_swap(Context& context, const Arguments& arguments) {
  auto options = swap_options(arguments);
  if (!options) return fail(options.error());
  const auto cabinet = context.front_end->cabinet();
  if (!cabinet) return fail(cabinet.error());
  const auto axes = (*cabinet)->select(arguments.text("axis"));
  if (!axes) return fail(axes.error());
  if (axes->size() != 1)
    return fail(Errc::usage, message("{} names {} axes", as_it_is(arguments.text("axis")), axes->size()),
                "one drive is replaced at a time");
  const auto families = drive::find_families(context.drive_folders);
  options->apply.choice.families = families;
  return cabinet::swap_axis(context, **cabinet, open_station(context, **cabinet, *axes->front()), *options);
}

constexpr Example kCabinetSwapExamples[] = {
    {"cabinet swap lift", "the new drive is at the node of the axis already"},
    {"cabinet swap lift --from 1", "it is at node 1, as from the factory"},
    {"cabinet swap lift --backup backup-2026-11-22T19-40-00Z",
     "restore all that was saved of the axis, not the file's values alone"},
};

}  // namespace

extern const Command kCabinetSwap;
const Command kCabinetSwap{
    .path = "cabinet swap",
    .summary = "Put a new drive into the place of an axis",
    .details =
        "Step by step, and what changes the drive asks first: the new drive is found (at the node of the axis, or --from NODE), held "
        "against the family of the axis, and its serial number is shown beside the one in the file; it "
        "gets the node of the axis as `address` does it, and the parameters, PDOs and heartbeat of the "
        "file as `cabinet apply` does it. --backup DIR restores everything that was saved of the axis "
        "instead, settings that are not in the file as well. The line of the cabinet file with the new "
        "serial number is told, not written. What cannot be put back is told: the encoder's offset and the "
        "home position. After a failure the line is repeated: what is done is not done again; what was "
        "interrupted while settings were written is continued by --resume.",
    .parameters = kCabinetSwapParameters,
    .examples = kCabinetSwapExamples,
    .needs = Needs::nothing,
    .effect = Effect::resets,
    .run = run_cabinet_swap,
};

}  // namespace servoctl::commands
