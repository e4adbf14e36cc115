#include "cli/terminal/prompt_words.hpp"

#include <fmt/format.h>
#include <set>

#include "base/printable.hpp"
#include "base/text.hpp"
#include "command/prompt_words.hpp"
#include "command/registry.hpp"

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
  if (*cabinet == nullptr) return fail(numbers.error());
  const auto axes = (*cabinet)->select(nodes);
  if (!axes) return fail(axes.error());
  return {};
}

/// A node, and the bus it is on.
struct Place {
  std::string bus;
  std::uint8_t node = 0;
  std::string name;
};

/// Bus and family of the axes, as the file says them; empty where it cannot be used.
std::string place_of_axes(Shell& shell, const Settings& settings, std::vector<Place>& places) {
  const auto cabinet = shell.cabinet(settings);
  if (!cabinet || *cabinet == nullptr) return {};
  const auto axes = (*cabinet)->select(settings.nodes);
  if (!axes) return {};
  std::set<std::string> buses;
  std::set<std::string> families;
  for (const auto* axis : *axes) {
    const auto* bus = (*cabinet)->bus(axis->bus);
    buses.insert(axis->bus);
    families.insert(axis->family);
    if (bus != nullptr) places.push_back({bus->url, axis->node, axis->name});
  }
  return fmt::format(" {} {} {}", fmt::join(buses, ","), settings.nodes, fmt::join(families, ","));
}

std::string place_of_nodes(Shell& shell, const Settings& settings, std::vector<Place>& places) {
  std::string out;
  const auto nodes =
      settings.nodes.empty() ? Result<std::vector<std::uint8_t>>() : parse_nodes(settings.nodes);
  if (!settings.bus.empty()) out += " " + settings.bus.substr(0, settings.bus.find('?'));
  if (!settings.nodes.empty()) out += (nodes ? " node " : " ") + settings.nodes;
  if (const auto family = shell.family_text(); !family.empty()) out += " " + family;
  for (const auto node : nodes.value_or(std::vector<std::uint8_t>()))
    if (node != 0) places.push_back({settings.bus, node, fmt::format("node {}", node)});
  return out;
}

/// Of one node its state; of several those that are in fault.
void add_states(Shell& shell, const std::vector<Place>& places, PromptText& out) {
  std::string text;
  for (const auto& place : places) {
    const auto state = shell.heard_state(place.bus, place.node);
    out.alarm = out.alarm || state.fault;
    if (state.text.empty() || (places.size() > 1 && !state.fault)) continue;
    append(text, (places.size() > 1 ? place.name + " " : "") + state.text + (state.old ? "?" : ""));
  }
  if (!text.empty()) out.text += " [" + text + "]";
}

}  // namespace

Result<session::Session*> open_chosen_bus(Shell& shell, const Settings& settings) {
  const bool may_be_name = settings.bus.find(':') == std::string::npos;
  const auto cabinet = may_be_name ? shell.cabinet(settings) : Result<const cabinet::Cabinet*>(nullptr);
  const auto* bus = cabinet && *cabinet != nullptr ? (*cabinet)->bus(settings.bus) : nullptr;
  return shell.open(bus == nullptr ? settings : on_bus(**cabinet, settings, *bus).settings);
}

PromptText prompt_text(Shell& shell) {
  const auto& settings = shell.defaults();
  std::vector<Place> places;
  PromptText out{.text = "servoctl", .alarm = false};
  std::string place;
  if (names_axes(settings.nodes)) place = place_of_axes(shell, settings, places);
  out.text += place.empty() ? place_of_nodes(shell, settings, places) : place;
  add_states(shell, places, out);
  out.text = printable(out.text) + "> ";
  return out;
}

bool is_exit(const std::vector<std::string>& words) {
  return words.size() == 1 && (words.front() == "exit" || words.front() == "quit");
}

bool is_choice(const std::vector<std::string>& words) { return find_place_word(words) != nullptr; }

Result<Settings> chosen(Shell& shell, Settings defaults, const std::vector<std::string>& words) {
  const auto* word = find_place_word(words);
  if (word == nullptr) return defaults;
  if (words.size() != 2)
    return fail(Errc::usage, fmt::format("'{}' takes one argument", word->name),
                fmt::format("`{}`: {}", command::prompt_usage(*word), word->summary));
  if (word->name == "use") {
    if (const auto known = check_nodes(shell, defaults, words[1]); !known) return fail(known.error());
    defaults.nodes = words[1];
  } else if (word->name == "drive") {
    if (const auto loaded = shell.profile(words[1]); !loaded) return fail(loaded.error());
    defaults.drive = words[1];
  } else {
    defaults.bus = words[1];
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
  shell.defaults() = std::move(*settings);
  return Outcome{.command = std::string(word->name), .settings = shell.defaults()};
}

}  // namespace servoctl::cli
