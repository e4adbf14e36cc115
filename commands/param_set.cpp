#include <algorithm>

#include "base/format.hpp"
#include "command/assignments.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "settings/change.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kParamSetParameters[] = {
    {.name = "assignment",
     .help = "ID VALUE, or ID=VALUE ID=VALUE …",
     .kind = Kind::parameter,
     .required = true,
     .many = true},
    kKeepOption,
    kUnlockOption,
};

struct WantedValue {
  drive::Target target;
  std::string_view id;
  std::string_view value;
};

/// What the words say; Errc::usage too for one parameter with two values: the drive would hold the last of
/// them.
Result<std::vector<WantedValue>> wanted_values(const Context& context, const Arguments& arguments) {
  const auto assignments = parse_assignments(arguments.all("assignment"));
  if (!assignments) return fail(assignments.error());
  std::vector<WantedValue> out;
  for (const auto& assignment : *assignments) {
    const auto target = drive::resolve_panel(*context.profile, assignment.id);
    if (!target) return fail(target.error());
    const auto same = std::find_if(out.begin(), out.end(), [&](const WantedValue& wanted) {
      return wanted.target.address == target->address;
    });
    if (same != out.end())
      return fail(Errc::usage,
                  message("two values for one parameter: {}={} and {}={}", as_it_is(same->id),
                          as_it_is(same->value), as_it_is(assignment.id), as_it_is(assignment.value)),
                  "nothing was written; say each parameter once");
    out.push_back({*target, assignment.id, assignment.value});
  }
  return out;
}

Result<void> check_param_set(Context& context, const Arguments& arguments) {
  const auto wanted = wanted_values(context, arguments);
  if (!wanted) return fail(wanted.error());
  for (const auto& [target, id, value] : *wanted)
    for (const auto node : context.nodes)
      if (const auto fits = settings::check_change(context, node, target, value, {}); !fits) return fits;
  return {};
}

Result<report::Value> run_param_set(Context& context, const Arguments& arguments) {
  const auto wanted = wanted_values(context, arguments);
  if (!wanted) return fail(wanted.error());
  std::vector<settings::Change> changes;
  for (const auto node : context.nodes) {
    for (const auto& [target, id, value] : *wanted) {
      auto change = settings::make_change(context, node, target, value, {});
      if (!change) return fail(change.error());
      changes.push_back(std::move(*change));
    }
  }
  settings::WriteOptions options{
      .keep = arguments.has("--keep"), .unlock = arguments.has("--unlock"), .leave_equal = true};
  if (context.dry_run) return settings::planned_changes(context, changes, options);
  if (const auto confirmed = settings::confirm_changes(context, changes); !confirmed)
    return fail(confirmed.error());
  // A write-only parameter starts an action and has nothing to read back.
  options.read_back = std::all_of(changes.begin(), changes.end(), [](const settings::Change& c) {
    return od::readable(drive::meaning(c.target, c.node).access);
  });
  return settings::write_changes(context, changes, options);
}

Result<std::vector<settings::NamedValue>> parameter_values(const Arguments& arguments) {
  const auto assignments = parse_assignments(arguments.all("assignment"));
  if (!assignments) return fail(assignments.error());
  std::vector<settings::NamedValue> out;
  for (const auto& assignment : *assignments)
    out.push_back({std::string(assignment.id), std::string(assignment.value), true});
  return out;
}

constexpr Example kParamSetExamples[] = {
    {"param set Pn0214 45Hz -n 1 -d gsd600", "read back; tells when it takes effect"},
    {"param set Pn0202=50Hz Pn0214=45Hz --keep -n 1 -d gsd600", "several, kept over power-off"},
    {"param set Fn_00 20 --unlock --keep -n 1 -d ts", "one that the drive's password locks"},
};

}  // namespace

extern const Command kParamSet;
const Command kParamSet{
    .path = "param set",
    .summary = "Change panel parameters of a drive and read them back",
    .details =
        "All values are checked before the first frame. A plain number is the number the panel shows (Pn0214 400), a number with a unit is converted (Pn0214 40Hz), a label stands for its value. A value that the drive holds already is not written again (unchanged). Stops at the first refusal. The result shows whether the value was read back and when it takes effect.",
    .parameters = kParamSetParameters,
    .examples = kParamSetExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::writes,
    .run = run_param_set,
    .check = check_param_set,
    .settings = parameter_values,
    .on_registers = true,
};

}  // namespace servoctl::commands
