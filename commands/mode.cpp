
#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "motion/operation_mode.hpp"
#include "motion/power.hpp"
#include "show/planned_messages.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

constexpr Parameter kModeParameters[] = {
    {.name = "mode",
     .help = "number or name (pp, pv, hm …); without it, shows the present mode",
     .kind = Kind::value},
};

/// By number, by label, by what stands in its parentheses (`pv`), or by its first words.
Result<std::int8_t> parse_mode(const drive::Profile& profile, std::string_view text) {
  const auto meaning = drive::meaning(drive::target_at(&profile, objects::kModeOfOperation), 0);
  if (const auto* label = drive::find_label(meaning, text)) return static_cast<std::int8_t>(label->value);
  if (const auto value = od::parse_value(od::DataType::i8, text))
    return static_cast<std::int8_t>(od::to_double(*value));
  std::vector<std::string> offered;
  if (meaning.labels != nullptr)
    for (const auto& label : *meaning.labels)
      for (const auto word : drive::label_words(label.label)) offered.emplace_back(word);
  const auto near = did_you_mean(text, offered);
  return fail(Errc::usage, message("'{}' is not a mode of this family", as_it_is(text)),
              !near.empty()     ? near
              : offered.empty() ? Message("write its number: 1 to 10 are the CiA 402 modes")
                                : Message("`objects 0x6060` lists them"));
}

struct WantedMode {
  std::uint8_t node;
  std::int8_t mode;
};

/// Errc::refused where a new mode is none of the drive's, or could move it.
Result<void> check_change(Context& context, const WantedMode& wanted) {
  auto& session = *context.session;
  const auto& profile = *context.profile;
  if (const auto known = motion::check_mode(session, profile, wanted.node, wanted.mode); !known) return known;
  motion::Power power(session, profile, wanted.node);
  const auto state = power.state();
  if (!state) return fail(state.error());
  if (!drive::is_energised(*state)) return {};
  return fail(drive_error(Errc::refused, wanted.node,
                          message("is energised ({}): a mode change may move it", drive::name(*state)),
                          "`disable` it first"));
}

/// What such a mode does, no standard and no data say.
Result<void> confirm_maker_mode(Context& context, std::int8_t mode) {
  if (!motion::is_unknown_maker_mode(*context.profile, mode)) return {};
  return context.confirm(formatted(
      "Mode {} is a manufacturer-specific mode: servoctl does not know what the drive does in it, and moves "
      "nothing. Write it to 0x6060?",
      mode));
}

Value planned_mode(Context& context, std::int8_t mode) {
  std::vector<session::PlannedMessage> messages;
  for (const auto node : context.nodes) {
    if (const auto possible = check_change(context, {node, mode}); !possible)
      context.errors.push_back(possible.error());
    else
      messages.push_back(session::planned_write(motion::mode_write(*context.profile, node, mode)));
  }
  return show::planned_messages(context, messages);
}

Result<Value> run_mode(Context& context, const Arguments& arguments) {
  std::optional<std::int8_t> wanted;
  if (arguments.has("mode")) {
    const auto mode = parse_mode(*context.profile, arguments.text("mode"));
    if (!mode) return fail(mode.error());
    wanted = *mode;
  }
  if (wanted && context.dry_run) return planned_mode(context, *wanted);
  if (wanted)
    if (const auto answer = confirm_maker_mode(context, *wanted); !answer) return fail(answer.error());
  report::Table table;
  table.columns = {{"node"},
                   {"text", "mode", Show::text},
                   {"mode", "", Show::json},
                   {"result"},
                   {"error", "", Show::json}};
  for (const auto node : context.nodes) {
    const auto possible = wanted ? check_change(context, {node, *wanted}) : Result<void>{};
    const auto done =
        possible && wanted ? motion::set_mode(*context.session, *context.profile, node, *wanted) : possible;
    const auto mode = motion::read_mode(*context.session, node);
    if (!done) context.errors.push_back(done.error());
    if (done && !mode) context.errors.push_back(mode.error());
    const auto* failure = !done ? &done.error() : !mode ? &mode.error() : nullptr;
    table.rows.push_back({node,
                          mode ? Value(motion::mode_text(*context.profile, *mode, context.chinese)) : Value(),
                          mode ? Value(*mode) : Value(),
                          !possible && mode    ? "not changed"
                          : failure != nullptr ? "failed"
                          : wanted             ? "set"
                                               : "",
                          failure != nullptr ? show::error_record(*failure) : Value()});
  }
  return Value(std::move(table));
}

Result<void> check_mode_word(Context& context, const Arguments& arguments) {
  if (!arguments.has("mode") || context.profile == nullptr) return {};
  const auto mode = parse_mode(*context.profile, arguments.text("mode"));
  return mode ? Result<void>() : fail(mode.error());
}

constexpr Example kModeExamples[] = {
    {"mode -n 1 -d gsd600", "the present mode"},
    {"mode pv -n 1 -d gsd600", "profile velocity; only while de-energised"},
    {"mode -3 --dry-run -n 1 -d cia402", "what a mode of the manufacturer's own would send"},
};

}  // namespace

extern const Command kMode;
const Command kMode{
    .path = "mode",
    .summary = "Show or set the mode of operation (6060h)",
    .details =
        "Names are the family's own: `mode pv`, `mode \"Profile velocity\"`, `mode 3`. Refused if the family "
        "or the drive (6502h) does not support the mode, and while the drive is energised. Waits until 6061h "
        "shows it. A manufacturer-specific mode (below 0) of a drive without data of its own (-d cia402, -d "
        "FILE) is written after a question.",
    .parameters = kModeParameters,
    .examples = kModeExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::writes,
    .reads_without = "mode",
    .run = run_mode,
    .check = check_mode_word,
};

}  // namespace servoctl::commands
