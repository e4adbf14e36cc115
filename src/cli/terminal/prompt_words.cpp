#include "cli/terminal/prompt_words.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <array>
#include <set>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "cli/batch/batch_command.hpp"
#include "cli/bus_choice.hpp"
#include "cli/parse.hpp"
#include "cli/restriction.hpp"
#include "cli/terminal/ascii_form.hpp"
#include "cli/terminal/begun_place.hpp"
#include "cli/words.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"
#include "report/catalogue.hpp"

namespace servoctl::cli {
namespace {

/// `bus up can0` is a command, `bus can0` a choice.
const command::PromptWord* find_place_word(const std::vector<std::string>& words) {
  if (words.empty()) return nullptr;
  if (words.size() > 1 && command::find_command(words[0] + " " + words[1]) != nullptr) return nullptr;
  const auto* word = command::find_prompt_word(words.front());
  return word != nullptr && word->is_place ? word : nullptr;
}

/// Numbers, or axes of the cabinet.
Result<void> check_nodes(Shell& shell, const Settings& settings, const std::string& nodes) {
  const auto numbers = parse_nodes(nodes);
  if (numbers) return {};
  const auto cabinet = names_axes(nodes) ? shell.cabinet(settings) : Result<const cabinet::Cabinet*>(nullptr);
  if (!cabinet) return fail(cabinet.error());
  if (*cabinet == nullptr)
    return fail(Errc::usage, numbers.error().message,
                names_axes(nodes) ? "`use 1`, `use 1,3,5-8` or `use all`; axes have names in a cabinet file, "
                                    "and none is in use here"
                                  : "`use 1`, `use 1,3,5-8` or `use all`");
  const auto axes = (*cabinet)->select(nodes);
  if (!axes) return fail(axes.error());
  return {};
}

/// A node, and the bus it is on.
struct Place {
  std::string bus;
  std::uint8_t node = 0;
  std::string name;
  std::string family;
};

std::string in_language(const std::string& english, bool chinese) {
  return chinese ? report::in_chinese(english) : english;
}

/// What stands in the prompt.
struct Parts {
  std::string bus;
  std::string nodes;
  std::string family;
  std::string states;

  std::string text(bool with_program) const {
    std::string out(with_program ? "servoctl" : "");
    for (const auto* part : {&bus, &nodes, &family, &states})
      if (!part->empty()) out += (out.empty() ? "" : " ") + *part;
    return printable(out) + "> ";
  }
};

/// Down to `least` columns; of a place in a folder, or on another machine, its last name first.
void shorten(std::string& part, std::size_t least, std::size_t too_wide) {
  const auto slash = part.rfind('/');
  if (too_wide > 0 && slash != std::string::npos && slash > 1) {
    const auto before = display_width(part);
    part = "…" + part.substr(slash + 1);
    too_wide -= std::min(too_wide, before - std::min(before, display_width(part)));
  }
  const auto width = display_width(part);
  if (too_wide > 0 && width > least) part = clip(part, std::max(least, width - std::min(width, too_wide)));
}

/// In five eighths of the window where that can be: the bus gives way, then the name of the program, then the
/// family, of which enough stays to know it by, and that it is a guess; the nodes and their state never do.
std::string in_window(Parts parts, std::size_t window) {
  constexpr std::size_t kLeastBus = 8;
  constexpr std::size_t kLeastFamily = 6;
  constexpr std::size_t kLeastSaved = 2;
  const auto most = window == 0 ? std::string::npos : window * 5 / 8;
  const auto too_wide = [most](const Parts& all, bool with_program) {
    const auto width = display_width(all.text(with_program));
    return width > most ? width - most : 0;
  };
  auto named = parts;
  shorten(named.bus, kLeastBus, too_wide(named, true));
  if (too_wide(named, true) == 0) return named.text(true);
  shorten(parts.bus, kLeastBus, too_wide(parts, false));
  const bool guessed = parts.family.ends_with('?');
  if (display_width(parts.family) >= kLeastFamily + kLeastSaved)
    shorten(parts.family, kLeastFamily, too_wide(parts, false));
  if (guessed && !parts.family.ends_with('?')) parts.family += '?';
  return parts.text(false);
}

/// Bus and family of the axes, as the file says them; false where it cannot be used.
bool place_of_axes(Shell& shell, const Settings& settings, Parts& parts, std::vector<Place>& places) {
  const auto cabinet = shell.cabinet(settings);
  if (!cabinet || *cabinet == nullptr) return false;
  const auto axes = (*cabinet)->select(settings.nodes);
  if (!axes) return false;
  std::set<std::string> buses;
  std::set<std::string> families;
  for (const auto* axis : *axes) {
    const auto* bus = (*cabinet)->bus(axis->bus);
    buses.insert(axis->bus);
    families.insert(axis->family);
    if (bus != nullptr) places.push_back({bus->url, axis->node, axis->name, axis->family});
  }
  parts.bus = formatted("{}", fmt::join(buses, ","));
  parts.nodes = settings.nodes;
  parts.family = formatted("{}", fmt::join(families, ","));
  return true;
}

void place_of_nodes(Shell& shell, const Settings& settings, Parts& parts, std::vector<Place>& places) {
  const auto nodes =
      settings.nodes.empty() ? Result<std::vector<std::uint8_t>>() : parse_nodes(settings.nodes);
  parts.bus = settings.bus.substr(0, settings.bus.find('?'));
  if (!settings.nodes.empty())
    parts.nodes =
        nodes ? in_language(formatted("node {}", settings.nodes), settings.chinese) : settings.nodes;
  // What the cabinet file says of the node holds for the lines.
  const auto of_axis = family_in_cabinet(settings, shell);
  const auto family = of_axis.empty() ? shell.family_in_use() : of_axis;
  parts.family = of_axis.empty() ? shell.family_text() : of_axis;
  for (const auto node : nodes.value_or(std::vector<std::uint8_t>()))
    if (node != 0)
      places.push_back(
          {settings.bus, node, in_language(formatted("node {}", node), settings.chinese), family});
}

/// Of one node its state; of several those that are in fault. The answer: whether any is.
bool add_states(Shell& shell, const std::vector<Place>& places, Parts& parts) {
  std::string text;
  bool alarm = false;
  for (const auto& place : places) {
    const auto state = shell.heard_state(place.bus, place.node, place.family);
    alarm = alarm || state.fault;
    if (state.text.empty() || (places.size() > 1 && !state.fault)) continue;
    const auto told = in_language(state.text, shell.defaults().chinese);
    append(text, (places.size() > 1 ? place.name + " " : "") + told + (state.unsure ? "?" : ""),
           shell.defaults().chinese ? "，" : ", ");
  }
  if (!text.empty()) parts.states = "[" + text + "]";
  return alarm;
}

}  // namespace

Result<session::Session*> open_chosen_bus(Shell& shell, const Settings& settings) {
  const bool may_be_name = settings.bus.find(':') == std::string::npos;
  const auto cabinet = may_be_name ? shell.cabinet(settings) : Result<const cabinet::Cabinet*>(nullptr);
  const auto* bus = cabinet && *cabinet != nullptr ? (*cabinet)->bus(settings.bus) : nullptr;
  return shell.open(bus == nullptr ? settings : on_bus(**cabinet, settings, *bus).settings);
}

PromptText prompt_text(Shell& shell, std::size_t window) {
  const auto& settings = shell.defaults();
  std::vector<Place> places;
  Parts parts;
  if (!names_axes(settings.nodes) || !place_of_axes(shell, settings, parts, places))
    place_of_nodes(shell, settings, parts, places);
  const bool alarm = add_states(shell, places, parts);
  return {.text = in_window(std::move(parts), window), .alarm = alarm};
}

namespace {

/// What `bus` and `drive` may name in a restricted run. The name of a bus of the cabinet is looked at when it
/// is opened.
Result<void> check_restricted(const command::PromptWord& word, const std::string& name) {
  const auto* restriction = Restriction::current();
  if (restriction == nullptr || word.name == "use") return {};
  if (word.name == "drive") return restriction->check_family(name);
  return name.find(':') == std::string::npos ? Result<void>() : restriction->check_bus(name);
}

/// What an axis is, its file says.
Result<void> check_family_of_axis(Shell& shell, const Settings& settings) {
  const auto family = family_in_cabinet(settings, shell);
  if (family.empty() || family == settings.drive) return {};
  return fail(Errc::usage,
              message("{} is {} by the cabinet file, not {}", as_it_is(settings.nodes), as_it_is(family),
                      as_it_is(settings.drive)),
              "`use` chooses other nodes; or change `family` in the file");
}

/// A word that contradicts an earlier one ends what that chose.
void tell_left(Shell& shell, const Settings& next) {
  const auto& now = shell.defaults();
  const auto tell = [&](std::string_view what, const std::string& before, const std::string& after) {
    if (!before.empty() && after.empty())
      shell.console().note(formatted("notice: {} {} is no longer chosen: the cabinet file says otherwise\n",
                                     what, printable(before)));
  };
  tell("bus", now.bus, next.bus);
  tell("drive family", now.drive, next.drive);
  tell("the axis", now.nodes, next.nodes);
}

}  // namespace

PromptText dressed_prompt(Shell& shell, const Console& console) {
  auto out = prompt_text(shell, console.width());
  if (console.is_ascii()) out.text = ascii_form(out.text);
  out.alarm = out.alarm && has_colours(console.colour(), STDOUT_FILENO);
  return out;
}

namespace {

/// `Pn0214`, `PA-21`, `P0.03`, `P3-30`, `Fn_20B`: one or two letters, then a number, of groups where there
/// are several. Behind `_` and `-` it may be hexadecimal.
bool is_panel_number(std::string_view word) {
  const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  constexpr std::string_view kDigits = "0123456789";
  std::size_t at = 0;
  while (at < word.size() && at < 2 && is_letter(word[at])) ++at;
  if (at == 0) return false;
  if (word.find_first_not_of("0123456789.", at) == std::string_view::npos)
    return at < word.size() && word[at] != '.';
  at = word.find_first_not_of("0123456789.", at);
  if (word[at] != '_' && word[at] != '-') return false;
  return ++at < word.size() && kDigits.find(word[at]) != std::string_view::npos &&
         word.find_first_not_of("0123456789.ABCDEFabcdef", at) == std::string_view::npos;
}

/// A value, not an option: `-5` is one too.
bool is_value(const std::string& word) {
  return !word.starts_with('-') || (word.size() > 1 && word.find_first_of("0123456789.") == 1);
}

}  // namespace

std::vector<std::string> as_parameter_line(std::vector<std::string> words) {
  if (words.empty()) return words;
  const auto equals = words.front().find('=');
  if (!is_panel_number(std::string_view(words.front()).substr(0, equals))) return words;
  bool sets = equals != std::string::npos;
  if (!sets && words.size() > 1 && words[1].starts_with('=')) {
    words.front() += words[1];
    words.erase(words.begin() + 1);
    sets = true;
  }
  if (sets && words.front().ends_with('=') && words.size() > 1 && is_value(words[1])) {
    words.front() += words[1];
    words.erase(words.begin() + 1);
  }
  const std::array<std::string, 2> command{"param", sets ? "set" : "get"};
  words.insert(words.begin(), command.begin(), command.end());
  return words;
}

bool is_exit(const std::vector<std::string>& words) {
  return words.size() == 1 && (words.front() == "exit" || words.front() == "quit");
}

bool is_choice(const std::vector<std::string>& words) { return find_place_word(words) != nullptr; }

Result<Settings> chosen(Shell& shell, Settings defaults, const std::vector<std::string>& words) {
  const auto* word = find_place_word(words);
  if (word == nullptr) return defaults;
  if (words.size() != 2)
    return fail(Errc::usage, message("'{}' takes one argument", as_it_is(word->name)),
                message("`{}`: {}", as_it_is(command::prompt_usage(*word)), word->summary));
  if (const auto allowed = check_restricted(*word, words[1]); !allowed) return fail(allowed.error());
  if (word->name == "use") {
    if (const auto known = check_nodes(shell, defaults, words[1]); !known) return fail(known.error());
    defaults.nodes = words[1];
    defaults.nodes_from = Source::set;
    if (!names_axes(defaults.nodes)) return defaults;
    // Where axes are, and what they are, the file says: the later word holds.
    const auto cabinet = shell.cabinet(defaults);
    if (cabinet && *cabinet != nullptr && !are_on_bus(**cabinet, defaults)) defaults.bus.clear();
    if (cabinet && *cabinet != nullptr && !are_of_family(**cabinet, defaults)) defaults.drive.clear();
  } else if (word->name == "drive") {
    if (const auto loaded = shell.profile(words[1]); !loaded) return fail(loaded.error());
    defaults.drive = words[1];
    defaults.drive_from = Source::set;
    if (const auto right = check_family_of_axis(shell, defaults); !right) return fail(right.error());
  } else {
    defaults.bus = words[1];
    defaults.bus_from = Source::set;
    const auto cabinet =
        names_axes(defaults.nodes) ? shell.cabinet(defaults) : Result<const cabinet::Cabinet*>(nullptr);
    if (cabinet && *cabinet != nullptr && !are_on_bus(**cabinet, defaults)) defaults.nodes.clear();
  }
  return defaults;
}

std::optional<Outcome> choose(Shell& shell, const std::vector<std::string>& words) {
  const auto* word = find_place_word(words);
  if (word == nullptr) return std::nullopt;
  auto settings = chosen(shell, shell.defaults(), words);
  if (!settings) return failed(settings.error(), shell.defaults(), word->name);
  if (word->name == "bus")
    if (const auto opened = open_chosen_bus(shell, *settings); !opened)
      return failed(opened.error(), shell.defaults(), word->name);
  tell_left(shell, *settings);
  shell.defaults() = std::move(*settings);
  return Outcome{.command = std::string(word->name), .settings = shell.defaults()};
}

bool may_move(const std::string& line) {
  const auto typed = split_words(line);
  if (!typed || typed->empty()) return false;
  const auto words = as_parameter_line(*typed);
  const auto match = match_command(words);
  return is_batch(words) || (match.command != nullptr && match.command->effect >= command::Effect::moves);
}

}  // namespace servoctl::cli
