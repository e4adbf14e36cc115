#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/text.hpp"
#include "can/socketcan.hpp"
#include "cli/bus_choice.hpp"
#include "cli/restriction.hpp"
#include "cli/shell.hpp"

/// Where a line goes: its nodes, its bus, and the axes of the cabinet file.
namespace servoctl::cli {
namespace {

using command::Needs;

/// A word without a colon that is no interface may be the name of a bus in the cabinet.
bool may_name_bus(const std::string& bus) {
  return !bus.empty() && bus.find(':') == std::string::npos && !can::is_interface(bus);
}

/// Both are given, and the bus is not the stronger one.
bool file_rivals_bus(const Settings& settings) {
  return !settings.bus.empty() && settings.cabinet_from != Source::folder &&
         settings.cabinet_from >= settings.bus_from;
}

/// `-n all` beside a cabinet file means its axes only where the line goes by the file.
void tell_all_of_bus(const command::Command& command, const Settings& settings,
                     std::vector<Message>& notices) {
  if (!equals_nocase(settings.nodes, "all") || settings.bus.empty() || settings.bus_from == Source::line ||
      !includes(command.needs, Needs::node))
    return;
  std::error_code error;
  const auto file = cabinet::find_cabinet(std::filesystem::current_path(error));
  if (!file.empty())
    notices.push_back(message("all: the nodes of {} ({}), not the axes of {}",
                              name_of(settings.bus_from, "--bus"), as_it_is(settings.bus),
                              as_it_is(file.string())));
}

/// What is shown while it runs, and what moves, is of one bus and family.
Result<void> check_several(const command::Command& command, const command::Arguments& arguments,
                           const std::vector<LinePart>& parts) {
  if (parts.size() < 2) return {};
  std::string first;
  for (const auto* axis : parts.front().axes) append(first, axis->name, ",");
  if (!command.one_file.empty() && arguments.has(command.one_file))
    return fail(
        Errc::usage,
        message(
            "'{}' writes {} for axes of one bus and one family at a time; these are of {} buses or families",
            as_it_is(command.path), as_it_is(arguments.text(command.one_file)), parts.size()),
        command.path == "backup"
            ? message("`cabinet backup` saves all axes; or a file each, such as -n {}", as_it_is(first))
            : message("a file each, such as -n {}", as_it_is(first)));
  if (!command.goes_on && command.effect_with(arguments) != command::Effect::moves) return {};
  return fail(
      Errc::usage,
      message("'{}' is for axes of one bus and one family at a time; these are of {} buses or families",
              as_it_is(command.path), parts.size()),
      first.empty()     ? message("name the bus: --bus {}", as_it_is(parts.front().settings.bus))
      : command.goes_on ? message("it listens to one bus as it comes in: such as -n {}, and the "
                                  "others in another terminal",
                                  as_it_is(first))
                        : message("such as -n {}", as_it_is(first)));
}

/// Bus and file contradict each other, and a drive is to be stopped: `all` are those of both, and numbers are
/// nodes of the bus.
Result<std::vector<LinePart>> ways_out(const cabinet::Cabinet& cabinet, const ParsedLine& line,
                                       const Settings& given, const Error& contradiction,
                                       std::vector<Message>& notices) {
  notices.push_back(contradiction.message);
  if (!equals_nocase(given.nodes, "all")) return std::vector<LinePart>();
  auto of_file = given;
  of_file.bus.clear();
  auto parts = parts_of(cabinet, *line.command, line.arguments, of_file, notices);
  if (!parts) return parts;
  parts->push_back({given, {}, {}});
  parts->back().settings.of_cabinet = true;  // The other buses stay open.
  return parts;
}

}  // namespace

std::vector<std::string> Shell::name_axes(std::vector<std::string> words, const CommandMatch& match) {
  if (match.command == nullptr || !includes(match.command->needs, Needs::node)) return words;
  const auto after = match.first + match.used;
  if (after >= words.size() || words[after].starts_with("-")) return words;
  auto settings = options_.defaults;
  for (std::size_t i = after; i < words.size(); ++i) {
    constexpr std::string_view kOption = "--cabinet";
    if (words[i] == kOption && i + 1 < words.size()) settings.cabinet = words[i + 1];
    if (words[i].starts_with(std::string(kOption) + "="))
      settings.cabinet = words[i].substr(kOption.size() + 1);
  }
  // A file that cannot be used is told when an axis is needed; the word may be no axis.
  const auto known = cabinet_.get(settings);
  if (!known || *known == nullptr) return words;
  return with_axis_option(std::move(words), *match.command, after, **known);
}

Result<std::vector<LinePart>> Shell::parts_of_line(const ParsedLine& line, const Settings& given,
                                                   std::vector<Message>& notices) {
  const auto& command = *line.command;
  // Before a file that it names is read.
  if (const auto* restriction = Restriction::current())
    if (const auto allowed = restriction->check_words(command, line.arguments); !allowed)
      return fail(allowed.error());
  const bool on_bus = includes(command.needs, Needs::bus);
  const bool named = names_axes(given.nodes);
  // The file may be the one that is to be made from this bus.
  const bool rivals =
      on_bus && !named && !command.opens_bus && command.path != "cabinet init" && file_rivals_bus(given);
  if (on_bus && !named && !rivals) tell_all_of_bus(command, given, notices);
  if (!named && !(on_bus && given.bus.empty()) && !may_name_bus(given.bus) && !rivals)
    return std::vector<LinePart>();
  const auto known = cabinet(given);
  if (!known && command.way_out && rivals) {
    notices.push_back(message("the cabinet file is not used: {}", known.error().message));
    return std::vector<LinePart>();
  }
  if (!known) return fail(known.error());
  if (*known == nullptr) return std::vector<LinePart>();
  const auto settings = rivals ? settle_bus(**known, given, notices) : given;
  if (!settings && command.way_out) return ways_out(**known, line, given, settings.error(), notices);
  if (!settings) return fail(settings.error());
  auto parts = parts_of(**known, command, line.arguments, *settings, notices);
  if (parts)
    if (const auto good = check_several(command, line.arguments, *parts); !good) return fail(good.error());
  return parts;
}

Result<Settings> Shell::settings_for_lines(Settings settings) {
  if (file_rivals_bus(settings)) {
    const auto known = cabinet(settings);
    if (!known) return fail(known.error());
    std::vector<Message> notices;
    auto settled = settle_bus(**known, std::move(settings), notices);
    if (!settled) return settled;
    settings = std::move(*settled);
    for (const auto& notice : notices) console_->note("notice: " + notice.text() + "\n");
  }
  settings.keep_for_lines();
  return settings;
}

}  // namespace servoctl::cli
