#include "cli/settings.hpp"

#include <algorithm>
#include <cstdlib>

#include "base/duration.hpp"
#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/node_list.hpp"
#include "cli/restriction.hpp"
#include "command/output_form.hpp"

namespace servoctl::cli {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

/// How results look.
void apply_form(Settings& settings, const command::Arguments& arguments) {
  // Where a command writes a file, its own --output may name that.
  if (const auto form = arguments.text("--output"); command::is_output_form(form)) {
    settings.json = form != "text";
    settings.samples = form == "jsonl";
  }
  if (arguments.has("--json")) settings.json = true;
  if (arguments.has("--color")) settings.colour = parse_colour(arguments.text("--color"));
  if (arguments.has("--lang")) settings.chinese = arguments.text("--lang") == "zh";
}

Result<void> check_contradictions(const command::Arguments& arguments) {
  if (arguments.has("--quiet") && arguments.has("--verbose"))
    return fail(Errc::usage, "--quiet and --verbose contradict each other", "leave one of them out");
  if (arguments.has("--json") && arguments.text("--output") == "text")
    return fail(Errc::usage, "--json and --output text contradict each other", "leave one of them out");
  return {};
}

}  // namespace

void Settings::keep_for_lines() {
  for (auto* from : {&bus_from, &nodes_from, &drive_from, &cabinet_from})
    *from = std::min(*from, Source::set);
}

std::string name_of(Source source, std::string_view option) {
  switch (source) {
    case Source::line: return std::string(option);
    case Source::set: return formatted("an earlier {}", option);
    case Source::environment: return "$SERVOCTL_" + upper(option.substr(2));
    case Source::folder: break;
  }
  return "the current folder";
}

bool wants_json(const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
    if (words[i] == "--json" || words[i] == "--output=json" || words[i] == "--output=jsonl" ||
        words[i] == "-ojson" || words[i] == "-ojsonl")
      return true;
    if ((words[i] == "-o" || words[i] == "--output") && i + 1 < words.size() &&
        (words[i + 1] == "json" || words[i + 1] == "jsonl"))
      return true;
  }
  return false;
}

bool wants_chinese(const std::vector<std::string>& words, bool otherwise) {
  constexpr std::string_view kLang = "--lang";
  for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
    if (words[i].starts_with("--lang=")) otherwise = words[i].substr(kLang.size() + 1) == "zh";
    if (words[i] == kLang && i + 1 < words.size()) otherwise = words[i + 1] == "zh";
  }
  return otherwise;
}

Colour wanted_colour(const std::vector<std::string>& words, Colour otherwise) {
  constexpr std::string_view kColour = "--color";
  for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
    if (words[i].starts_with("--color=")) otherwise = parse_colour(words[i].substr(kColour.size() + 1));
    if (words[i] == kColour && i + 1 < words.size()) otherwise = parse_colour(words[i + 1]);
  }
  return otherwise;
}

Settings settings_from_environment() {
  Settings out;
  out.bus = variable("SERVOCTL_BUS");
  out.nodes = variable("SERVOCTL_NODE");
  out.drive = variable("SERVOCTL_DRIVE");
  out.cabinet = variable("SERVOCTL_CABINET");
  if (!out.cabinet.empty()) out.cabinet_from = Source::environment;
  const auto language = variable("SERVOCTL_LANG");
  out.chinese = language.empty() ? variable("LANG").starts_with("zh") : language == "zh";
  return out;
}

Result<Settings> apply_options(Settings base, const command::Arguments& arguments) {
  const auto text = [&](std::string_view name, auto& into, Source& from) {
    if (!arguments.has(name)) return;
    into = std::string(arguments.text(name));
    from = Source::line;
  };
  text("--bus", base.bus, base.bus_from);
  text("--node", base.nodes, base.nodes_from);
  text("--drive", base.drive, base.drive_from);
  text("--cabinet", base.cabinet, base.cabinet_from);
  if (arguments.has("--timeout")) {
    const auto timeout = read_duration(arguments.text("--timeout"));
    if (!timeout || *timeout == Duration::zero())
      return fail(Errc::usage,
                  timeout ? message("--timeout: '{}' is too short", as_it_is(arguments.text("--timeout")))
                          : "--timeout: " + timeout.error().message,
                  timeout ? "write 500ms or 2s" : timeout.error().hint);
    base.timeout = *timeout;
  }
  if (arguments.has("--retries")) {
    const auto retries = parse_digits(arguments.text("--retries"), 10);
    if (!retries || *retries > 100)
      return fail(Errc::usage, message("--retries: '{}' is not a number from 0 to 100",
                                       as_it_is(arguments.text("--retries"))));
    base.retries = static_cast<std::uint32_t>(*retries);
  }
  if (const auto right = check_contradictions(arguments); !right) return fail(right.error());
  apply_form(base, arguments);
  // What a restricted file says of itself is no consent.
  base.yes = base.yes || (arguments.has("--yes") && Restriction::current() == nullptr);
  base.quiet = arguments.has("--quiet") || (base.quiet && !arguments.has("--verbose"));
  base.verbose = arguments.has("--verbose") || (base.verbose && !arguments.has("--quiet"));
  base.force_family = base.force_family || arguments.has("--force-family");
  base.read_only = base.read_only || arguments.has("--read-only");
  base.dry_run = base.dry_run || arguments.has("--dry-run");
  if (arguments.has("--trace")) base.trace = std::string(arguments.text("--trace"));
  return base;
}

Result<std::vector<std::uint8_t>> parse_nodes(std::string_view text) {
  if (equals_nocase(text, "all")) return std::vector<std::uint8_t>{0};
  return canopen::parse_node_ids(text, "write -n 1, -n 1,3,5-8 or -n all; node-IDs are 1 to 127");
}

}  // namespace servoctl::cli
