#include "cabinet/apply.hpp"

#include "command/cabinet_options.hpp"
#include "command/setting_options.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kCabinetApplyParameters[] = {
    kAxisOption,
    kOnlyOption,
    {.name = "--no-keep", .help = "write working values only; lost at power-off", .kind = Kind::flag},
    kUnlockOption,
    {.name = "--all-or-nothing", .help = "if one axis fails, put all back", .kind = Kind::flag},
    {.name = "--resume", .help = "resume the axes whose apply was interrupted", .kind = Kind::flag},
};

Result<report::Value> run_cabinet_apply(Context& context, const Arguments& arguments) {
  const auto cabinet = context.front_end->cabinet();
  if (!cabinet) return fail(cabinet.error());
  const auto stations = open_stations(context, **cabinet, arguments);
  if (!stations) return fail(stations.error());
  const auto families = drive::find_families(context.drive_folders);
  return cabinet::apply_cabinet(
      context, **cabinet, *stations,
      {.choice = {.only = std::string(arguments.text("--only")), .unlisted = false, .families = families},
       .keep = !arguments.has("--no-keep"),
       .unlock = arguments.has("--unlock"),
       .resume = arguments.has("--resume"),
       .all_or_nothing = arguments.has("--all-or-nothing")});
}

constexpr Example kCabinetApplyExamples[] = {
    {"cabinet apply", "show what differs, ask, write it to all axes and keep it"},
    {"cabinet apply --axis lift --no-keep", "one axis, to try the values until power-off"},
    {"cabinet apply --all-or-nothing", "if one axis fails, put all back"},
};

}  // namespace

extern const Command kCabinetApply;
const Command kCabinetApply{
    .path = "cabinet apply",
    .summary = "Make the drives hold what the cabinet file says",
    .details =
        "A drive that its serial number tells at another node of the bus gets the node of its axis first, as "
        "`address` does it, after a question of its own (not with --all-or-nothing, --only, --resume or "
        "--dry-run). Then the plan is shown, asked for once, and exactly "
        "that is written, to all drives at the same time. Each drive is "
        "changed as `restore` does it: its present values are saved next to the cabinet file "
        "(FILE.before-AXIS.json), every value is read back, and at the end all are kept (--no-keep: not). "
        "If a write fails, the old values of that drive are written back and the others go on; with "
        "--all-or-nothing all are put back. A drive that has changed since the plan was shown, one that is "
        "energised, and one that is another than the file says is left alone; with --all-or-nothing nothing is "
        "written to any then. After a pulled cable or a "
        "crash --resume continues; `restore FILE.before-AXIS.json -n AXIS` restores the old values. A second "
        "apply does nothing.",
    .parameters = kCabinetApplyParameters,
    .examples = kCabinetApplyExamples,
    .needs = Needs::nothing,
    .effect = Effect::resets,
    .run = run_cabinet_apply,
};

}  // namespace servoctl::commands
