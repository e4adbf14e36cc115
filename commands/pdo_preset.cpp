#include <algorithm>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "command/setting_options.hpp"
#include "pdo/pdo_recipes.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kPdoPresetParameters[] = {
    {.name = "preset",
     .help = "name of the mapping, such as pp, pv or home; `drives FAMILY` lists those of a family",
     .required = true},
    kKeepOption,
    kUnlockOption,
};

Result<const drive::PdoPreset*> preset_of(const Context& context, const Arguments& arguments) {
  const auto& presets = context.profile->rules.pdo.presets;
  const auto word = arguments.text("preset");
  const auto found = std::find_if(presets.begin(), presets.end(),
                                  [&](const drive::PdoPreset& p) { return equals_nocase(p.name, word); });
  if (found != presets.end()) return &*found;
  std::vector<std::string> names;
  for (const auto& preset : presets) names.push_back(preset.name);
  return fail(
      Errc::usage,
      message("the manual of {} has no mapping for '{}'", as_it_is(context.profile->family), as_it_is(word)),
      names.empty() ? "it has none; `pdo map` makes one" : message("use {}", one_of(names)));
}

Result<void> check_pdo_preset(Context& context, const Arguments& arguments) {
  if (const auto preset = preset_of(context, arguments); !preset) return fail(preset.error());
  return {};
}

Result<report::Value> run_pdo_preset(Context& context, const Arguments& arguments) {
  const auto preset = preset_of(context, arguments);
  if (!preset) return fail(preset.error());
  const pdo::PdoEdit edit = [&](const pdo::PresentPdos& present) {
    return pdo::follow(*context.profile, present, (*preset)->pdos);
  };
  return pdo::change_pdos(context, edit,
                          {.keep = arguments.has("--keep"), .unlock = arguments.has("--unlock")});
}

constexpr Example kPdoPresetExamples[] = {
    {"pdo preset pv -n 1 -d gsd600", "for profile velocity, as the manual says"},
    {"pdo preset csp -n 1 -d sv2 -b coe:eth0", "for cyclic synchronous position on EtherCAT"},
};

}  // namespace

extern const Command kPdoPreset;
const Command kPdoPreset{
    .path = "pdo preset",
    .summary = "Map the PDOs as the manual recommends for a mode",
    .details =
        "The mappings in the family's manual for profile position (pp), profile velocity (pv), torque (pt), "
        "homing (home) and others; other PDOs stay unchanged. As safe as `pdo map`.",
    .parameters = kPdoPresetParameters,
    .examples = kPdoPresetExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::stores,
    .run = run_pdo_preset,
    .check = check_pdo_preset,
};

}  // namespace servoctl::commands
