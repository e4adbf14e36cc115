#include <fmt/format.h>

#include "base/text.hpp"
#include "commands/command.hpp"
#include "commands/records.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "session/operation_mode.hpp"
#include "session/power.hpp"

namespace servoctl::commands {
namespace {

using report::Show;
using report::Value;

constexpr Parameter kParameters[] = {
    {.name = "mode",
     .help = "number or name (pp, pv, hm …); shows the present one unless said",
     .kind = Kind::value},
};

std::vector<std::string> words_of(const std::string& label) {
  std::vector<std::string> out{label};
  const auto open = label.rfind('(');
  const auto close = label.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close < open) return out;
  out.push_back(label.substr(open + 1, close - open - 1));
  out.emplace_back(trim(std::string_view(label).substr(0, open)));
  return out;
}

/// By number, by label, by what stands in its parentheses (`pv`), or by its first words.
Result<std::int8_t> parse_mode(const drive::Profile& profile, std::string_view text) {
  const auto meaning = drive::meaning(drive::target_at(&profile, objects::kModeOfOperation), 0);
  std::vector<std::string> offered;
  if (meaning.labels != nullptr) {
    for (const auto& label : *meaning.labels)
      for (auto& word : words_of(label.label)) {
        if (equals_nocase(word, text)) return static_cast<std::int8_t>(label.value);
        offered.push_back(std::move(word));
      }
  }
  const auto value = od::parse_value(od::DataType::i8, text);
  const auto near = did_you_mean(text, offered);
  const auto hint = near.empty() ? std::string("`objects 0x6060` lists them") : near;
  if (!value) return fail(Errc::usage, fmt::format("'{}' is no mode of this family", text), hint);
  return static_cast<std::int8_t>(od::to_double(*value));
}

struct Wanted {
  std::uint8_t node;
  std::int8_t mode;
};

Result<void> change(Context& context, const Wanted& wanted) {
  auto& session = *context.session;
  const auto& profile = *context.profile;
  if (const auto known = session::check_mode(session, profile, wanted.node, wanted.mode); !known)
    return known;
  session::Power power(session, profile, wanted.node);
  const auto state = power.state();
  if (!state) return tl::unexpected<Error>(state.error());
  if (drive::is_energised(*state))
    return fail(session::drive_error(
        Errc::refused, wanted.node,
        fmt::format("is energised ({}): a new mode could move it at once", drive::name(*state)),
        "`disable` it first"));
  return session::set_mode(session, profile, wanted.node, wanted.mode);
}

Result<Value> run(Context& context, const Arguments& arguments) {
  std::optional<std::int8_t> wanted;
  if (arguments.has("mode")) {
    const auto mode = parse_mode(*context.profile, arguments.text("mode"));
    if (!mode) return tl::unexpected<Error>(mode.error());
    wanted = *mode;
  }
  report::Table table;
  table.columns = {{"node"},
                   {"text", "mode", Show::text},
                   {"mode", "", Show::json},
                   {"result"},
                   {"error", "", Show::json}};
  for (const auto node : context.nodes) {
    if (wanted && context.dry_run) {
      table.rows.push_back({node, session::mode_text(*context.profile, *wanted, context.chinese), *wanted,
                            "would be set", Value()});
      continue;
    }
    const auto done = wanted ? change(context, {node, *wanted}) : Result<void>{};
    const auto mode = session::read_mode(*context.session, node);
    if (!done) context.errors.push_back(done.error());
    if (done && !mode) context.errors.push_back(mode.error());
    const auto* failure = !done ? &done.error() : !mode ? &mode.error() : nullptr;
    table.rows.push_back(
        {node, mode ? Value(session::mode_text(*context.profile, *mode, context.chinese)) : Value(),
         mode ? Value(*mode) : Value(),
         failure != nullptr ? "failed"
         : wanted           ? "set"
                            : "",
         failure != nullptr ? error_record(*failure) : Value()});
  }
  return Value(std::move(table));
}

}  // namespace

extern const Command kMode;
const Command kMode{
    .path = "mode",
    .summary = "Show or set the mode of operation (6060h)",
    .details =
        "Names are the family's own: `mode pv`, `mode \"Profile velocity\"`, `mode 3`. Refused when the "
        "family or the "
        "drive (6502h) does not have the mode, and while the drive is energised. Waits until 6061h follows.",
    .parameters = kParameters,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::writes,
    .reads_without = "mode",
    .run = run,
};

}  // namespace servoctl::commands
