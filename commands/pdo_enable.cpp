
#include "base/format.hpp"
#include "command/setting_options.hpp"
#include "pdo/pdo_changing.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using canopen::Pdo;

constexpr Parameter kPdoEnableParameters[] = {
    {.name = "pdo", .help = "RPDO1, TPDO2, …", .kind = Kind::text, .required = true, .many = true},
    kKeepOption,
    kUnlockOption,
};

enum class Action : std::uint8_t { enable, disable, clear };

Result<void> act(const Context& context, const pdo::PresentPdos& present, Action action, Pdo pdo,
                 pdo::WantedPdos& out) {
  const bool linked = present.values.count({pdo.communication_index(), 1}) > 0;
  const auto name = canopen::name(pdo.direction, pdo.number);
  if (action == Action::enable && pdo.entries.empty())
    return fail(Errc::usage, name + " carries nothing yet", message("`pdo map {} OBJECT…`", as_it_is(name)));
  if (action == Action::clear) pdo.entries.clear();
  if (linked && action == Action::enable)
    if (const auto on = pdo::switch_on(pdo, present.node); !on) return on;
  if (linked && action != Action::enable) pdo.cob_id |= canopen::kPdoInvalid;
  if (!linked)
    if (const auto done =
            pdo::assign_pdo(*context.profile, present, pdo, action == Action::enable, out.assignments);
        !done)
      return done;
  out.pdos.push_back(std::move(pdo));
  return {};
}

Result<void> check_pdo_enable(Context&, const Arguments& arguments) {
  for (const auto& word : arguments.all("pdo"))
    if (!canopen::parse_pdo_name(word)) return fail(pdo::find_pdo({}, word).error());
  return {};
}

template <Action action>
Result<report::Value> run_pdo_enable(Context& context, const Arguments& arguments) {
  if (const auto fits = check_pdo_enable(context, arguments); !fits) return fail(fits.error());
  const pdo::PdoEdit edit = [&](const pdo::PresentPdos& present) -> Result<pdo::WantedPdos> {
    pdo::WantedPdos out;
    for (const auto& word : arguments.all("pdo")) {
      const auto pdo = pdo::find_pdo(present, word);
      if (!pdo) return fail(pdo.error());
      if (const auto done = act(context, present, action, *pdo, out); !done) return fail(done.error());
    }
    return out;
  };
  return pdo::change_pdos(context, edit,
                          {.keep = arguments.has("--keep"), .unlock = arguments.has("--unlock")});
}

template <Action action>
constexpr Command command(std::string_view path, std::string_view summary, std::string_view details,
                          std::span<const Example> examples) {
  return {.path = path,
          .summary = summary,
          .details = details,
          .parameters = kPdoEnableParameters,
          .examples = examples,
          .needs = Needs::node | Needs::dictionary,
          .effect = Effect::stores,
          .run = run_pdo_enable<action>,
          .check = check_pdo_enable};
}

constexpr Example kPdoEnableExamples[] = {
    {"pdo enable TPDO3 TPDO4 -n 1 -d gsd600",
     "as they are mapped: from the factory with position and with speed"},
};
constexpr Example kPdoDisableExamples[] = {
    {"pdo disable TPDO1 -n 1 -d gsd600", "not sent any more; what it carries stays"},
};
constexpr Example kPdoClearExamples[] = {
    {"pdo clear TPDO4 -n 1 -d gsd600", "off, and it carries nothing any more"},
};

}  // namespace

extern const Command kPdoEnable;
constexpr Command kPdoEnable = command<Action::enable>(
    "pdo enable", "Switch PDOs on",
    "Clears bit 31 of the COB-ID and keeps the others; on a family that assigns fixed PDOs, the PDO is "
    "assigned.",
    kPdoEnableExamples);

extern const Command kPdoDisable;
constexpr Command kPdoDisable = command<Action::disable>(
    "pdo disable", "Switch PDOs off", "Sets bit 31 of the COB-ID; the mapping stays for `pdo enable`.",
    kPdoDisableExamples);

extern const Command kPdoClear;
constexpr Command kPdoClear =
    command<Action::clear>("pdo clear", "Switch PDOs off, clear mapping",
                           "Switches the PDO off and clears its mapping.", kPdoClearExamples);

}  // namespace servoctl::commands
