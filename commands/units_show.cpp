
#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "cabinet/cabinet.hpp"
#include "command/command.hpp"
#include "command/motion_options.hpp"
#include "drive/standard_objects.hpp"
#include "motion/kept_turn.hpp"
#include "session/measure.hpp"
#include "show/drive_rules.hpp"
#include "show/identity.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using drive::Measure;
using report::List;
using report::Record;
using report::Show;
using report::Value;

constexpr Parameter kUnitsShowParameters[] = {kTurnOption};

constexpr std::pair<Measure, std::string_view> kMeasures[] = {
    {Measure::increments_per_turn, "increments_per_turn"},
    {Measure::pulses_per_turn, "pulses_per_turn"},
    {Measure::rated_torque, "rated_torque"}};

std::string_view unit_of(Measure measure) {
  switch (measure) {
    case Measure::increments_per_turn: return "inc";
    case Measure::pulses_per_turn: return "pulse";
    case Measure::rated_torque: return "Nm";
  }
  return {};
}

Value kept_record(const motion::KnownTurn& known) {
  if (!known.kept) return {};
  const auto& kept = *known.kept;
  return Record{{"counts", kept.counts},
                {"measured", kept.measured},
                {"uncertainty", static_cast<double>(kept.uncertainty_ppm) / 10000},
                {"why", kept.reason},
                {"time", kept.time},
                {"family", kept.family},
                {"identity", show::identity_record(kept.identity)},
                {"unused", report::text_or_null(known.unused)}};
}

std::string kept_text(const motion::KnownTurn& known) {
  return formatted("kept: {} counts ({}), measured at {}", known.kept->counts, known.kept->reason,
                   known.kept->time);
}

std::string_view position_unit(const drive::Profile& profile) {
  return drive::meaning(drive::target_at(&profile, objects::kPositionActual), 0).unit;
}

/// A turn that the cabinet file gives the axis comes like the option.
std::string_view turn_source(const Context& context, std::uint8_t node) {
  const bool of_file = std::any_of(context.axes.begin(), context.axes.end(), [node](const auto* axis) {
    return axis->node == node && axis->turn.has_value();
  });
  return of_file ? "`turn` of the axis in the cabinet file" : "--turn";
}

/// One measure of one node: what it is, and who tells it.
List row(const Context& context, std::uint8_t node, Measure measure, std::string_view name,
         std::optional<double> turn, const motion::KnownTurn& known) {
  const bool of_turn = measure == Measure::increments_per_turn;
  const session::MeasureQuestion question[] = {
      {node, measure, of_turn ? known.counts : std::optional<double>()}};
  const auto told = session::read_measures(*context.session, *context.profile, question).front();
  std::optional<double> value;
  std::string_view source;
  std::string from = "not known";
  if (const auto unit = position_unit(*context.profile); of_turn && unit != "inc") {
    from = formatted("not needed: positions are in {}{}", unit, turn ? "; --turn changes nothing" : "");
  } else if (of_turn && turn) {
    value = turn;
    source = "--turn";
    from = turn_source(context, node);
  } else if (told) {
    value = told->value;
    source = told->learned ? "kept" : "drive";
    from = told->learned ? kept_text(known) : "the drive: " + show::way_text(*told->way);
  } else if (of_turn) {
    from += context.profile->rules.learn.speed.empty() ? ": use --turn" : ": use `units learn` or --turn";
  }
  return {node,
          name,
          value ? Value(parse_real(plain_number(*value, 12)).value_or(*value)) : Value(),
          unit_of(measure),
          report::text_or_null(std::string(source)),
          from,
          of_turn ? kept_record(known) : Value()};
}

Result<Value> run_units_show(Context& context, const Arguments& arguments) {
  const auto options = motion_options(context, arguments);
  if (!options) return fail(options.error());
  report::Table table;
  table.columns = {{"node"},
                   {"measure"},
                   {"value"},
                   {"unit"},
                   {"source", "", Show::json},
                   {"from", "", Show::text},
                   {"kept", "", Show::json}};
  for (const auto node : context.nodes) {
    const auto there = context.session->upload(node, objects::kDeviceType);
    if (!there && there.error().code != Errc::sdo_abort) {
      context.errors.push_back(there.error());
      continue;
    }
    const auto known = motion::find_turn(context, node);
    if (!known.unused.empty())
      context.notices.push_back(
          message("node {}: the kept counts per revolution are not used: {}", node_name(node), known.unused));
    for (const auto& [measure, name] : kMeasures)
      if (measure == Measure::increments_per_turn || context.profile->rules.units.count(measure) > 0)
        table.rows.push_back(row(context, node, measure, name, options->turn, known));
  }
  table.json_only = table.rows.empty();  // The errors say why.
  return Value(std::move(table));
}

constexpr Example kUnitsShowExamples[] = {
    {"units show -n 1 -d gsd600", "whether counts per revolution are known, and from where"},
    {"units show -n 1 -d ts --turn 10000", "with the counts of your motor's nameplate"},
};

}  // namespace

extern const Command kUnitsShow;
const Command kUnitsShow{
    .path = "units show",
    .summary = "Show counts per revolution and rated torque, and their source",
    .details =
        "Increments (6064h) and encoder pulses per revolution and rated torque, as far as the family's rules "
        "give them: from the drive's parameters, from what `units learn` kept, or from --turn or the cabinet file. In JSON "
        "`source` is drive, kept, --turn or null. What is kept but not used is shown with the reason.",
    .parameters = kUnitsShowParameters,
    .examples = kUnitsShowExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .family = FamilyCheck::always,
    .run = run_units_show,
};

}  // namespace servoctl::commands
