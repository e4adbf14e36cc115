#include "cabinet/displaced.hpp"

#include "command/cabinet_options.hpp"
#include "command/setting_options.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kCabinetPlanParameters[] = {
    kAxisOption,
    kOnlyOption,
    {.name = "--no-unlisted", .help = "do not read what is not in the file", .kind = Kind::flag},
};

Result<report::Value> run_cabinet_plan(Context& context, const Arguments& arguments) {
  const auto cabinet = context.front_end->cabinet();
  if (!cabinet) return fail(cabinet.error());
  const auto stations = open_stations(context, **cabinet, arguments);
  if (!stations) return fail(stations.error());
  const auto families = drive::find_families(context.drive_folders);
  const cabinet::PlanChoice choice{.only = std::string(arguments.text("--only")),
                                   .unlisted = !arguments.has("--no-unlisted"),
                                   .families = families};
  auto looks = cabinet::look_at_all(context, **cabinet, *stations, choice);
  if (choice.only.empty()) (void)cabinet::find_displaced(context, *stations, choice, looks);
  cabinet::tell_looks(context, looks);
  for (const auto& look : looks)
    for (const auto& error : look.plan ? look.plan->left : std::vector<Error>())
      context.errors.push_back(cabinet::of_axis(*look.axis, error));
  if (context.errors.empty() && cabinet::any_to_do(looks))
    context.errors.push_back(cabinet::something_to_do(**cabinet, looks));
  return report::Value(cabinet::plan_record(**cabinet, looks));
}

constexpr Example kCabinetPlanExamples[] = {
    {"cabinet plan", "what `cabinet apply` would write; exit code 1 if there is something"},
    {"cabinet plan --axis lift --only params --no-unlisted",
     "of one axis, parameters alone, nothing that is not in the file"},
};

}  // namespace

extern const Command kCabinetPlan;
const Command kCabinetPlan{
    .path = "cabinet plan",
    .summary = "Show what differs between the cabinet file and the drives",
    .details =
        "Reads all axes at the same time and lists, axis by axis, every parameter, PDO and heartbeat that "
        "the drive holds otherwise than the file says, with both values and what the change needs: a "
        "restart, standstill, the password, Pre-operational, a drive that is de-energised. Family and serial "
        "number are held against the file first; a drive that its serial number tells at another node of the "
        "bus is named with it. Settings that are not in the file and not as the factory "
        "left them stand apart; --no-unlisted saves reading them. Exit code 1 if there is something to do. "
        "Nothing is written; drives may be running. `cabinet apply` does what the plan says.",
    .parameters = kCabinetPlanParameters,
    .examples = kCabinetPlanExamples,
    .needs = Needs::nothing,
    .effect = Effect::reads,
    .run = run_cabinet_plan,
};

}  // namespace servoctl::commands
