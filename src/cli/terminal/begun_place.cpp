#include "cli/terminal/begun_place.hpp"

#include <algorithm>
#include <optional>

#include "show/known_drive.hpp"
#include "sim/cell_spec.hpp"

namespace servoctl::cli {
namespace {

/// The value that the last of these options has among the words, also as `--bus=can0` and `-bcan0`.
std::optional<std::string> value_of(const std::vector<std::string>& words, std::string_view name,
                                    std::string_view short_name) {
  std::optional<std::string> out;
  for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
    const std::string_view word = words[i];
    if ((word == name || (!short_name.empty() && word == short_name)) && i + 1 < words.size())
      out = words[++i];
    else if (word.starts_with(name) && word.substr(name.size()).starts_with("="))
      out = std::string(word.substr(name.size() + 1));
    else if (!short_name.empty() && word.starts_with(short_name) && word.size() > short_name.size())
      out = std::string(word.substr(short_name.size()));
  }
  return out;
}

Settings settings_of(const std::vector<std::string>& words, Settings base) {
  if (auto bus = value_of(words, "--bus", "-b")) base.bus = std::move(*bus);
  if (auto drive = value_of(words, "--drive", "-d")) base.drive = std::move(*drive);
  if (auto cabinet = value_of(words, "--cabinet", {})) base.cabinet = std::move(*cabinet);
  if (auto nodes = value_of(words, "--node", "-n")) {
    base.nodes = std::move(*nodes);
    base.nodes_from = Source::line;
  }
  if (const auto language = value_of(words, "--lang", {})) base.chinese = *language == "zh";
  return base;
}

/// The one family of all these; empty where there are several, or none.
template <typename Items>
std::string common_family(const Items& items) {
  std::string out;
  for (const auto& item : items) {
    if (!out.empty() && item != out) return {};
    out = item;
  }
  return out;
}

/// Of the nodes of the line those that are there; without nodes all.
std::string family_in_cell(const Settings& settings) {
  const auto begin = cell_begin(settings.bus);
  if (!begin) return {};
  const auto cell = sim::parse_cell_spec(std::string_view(settings.bus).substr(*begin), {});
  if (!cell) return {};
  const auto nodes = parse_nodes(settings.nodes);
  const bool all = settings.nodes.empty() || (nodes && nodes->front() == 0);
  std::vector<std::string> families;
  for (const auto& place : cell->places)
    if (all || (nodes && std::find(nodes->begin(), nodes->end(), place.node) != nodes->end()))
      families.push_back(place.family);
  return common_family(families);
}

std::string family_said_before(const Settings& settings, const Shell& shell) {
  const auto nodes = parse_nodes(settings.nodes);
  if (shell.state_folder().empty() || settings.bus.empty() || !nodes || nodes->front() == 0) return {};
  std::vector<std::string> families;
  for (const auto node : *nodes) {
    const auto known = show::KnownDriveFile(shell.state_folder(), settings.bus, node).read();
    if (!known || !*known) return {};
    families.push_back((*known)->family);
  }
  return common_family(families);
}

/// By each of the axes that are named.
bool cabinet_says_turn(const Settings& settings, Shell& shell) {
  if (!names_axes(settings.nodes)) return false;
  const auto cabinet = shell.cabinet(settings);
  if (!cabinet || *cabinet == nullptr) return false;
  const auto axes = (*cabinet)->select(settings.nodes);
  return axes &&
         std::all_of(axes->begin(), axes->end(), [](const auto* axis) { return axis->turn.has_value(); });
}

}  // namespace

std::string family_in_cabinet(const Settings& settings, Shell& shell) {
  const auto cabinet = shell.cabinet(settings);
  if (!cabinet || *cabinet == nullptr) return {};
  std::vector<std::string> families;
  if (names_axes(settings.nodes)) {
    const auto axes = (*cabinet)->select(settings.nodes);
    if (!axes) return {};
    for (const auto* axis : *axes) families.push_back(axis->family);
    return common_family(families);
  }
  const auto nodes = parse_nodes(settings.nodes);
  const auto* bus = (*cabinet)->bus(settings.bus);
  if (!nodes || bus == nullptr) return {};
  for (const auto node : *nodes)
    if (const auto* axis = (*cabinet)->at(bus->name, node)) families.push_back(axis->family);
  return families.size() == nodes->size() ? common_family(families) : std::string();
}

std::optional<std::size_t> cell_begin(std::string_view url) {
  for (const std::string_view scheme : {"sim:", "coe:sim:", "modbus:sim:"})
    if (url.starts_with(scheme)) return scheme.size();
  return std::nullopt;
}

BegunPlace begun_place(const std::vector<std::string>& words, Shell& shell) {
  const auto& defaults = shell.defaults();
  BegunPlace out{.settings = settings_of(words, defaults), .family = {}};
  const auto& line = out.settings;
  const bool as_before = line.bus == defaults.bus && line.nodes == defaults.nodes;
  out.family = value_of(words, "--drive", "-d").value_or("");
  if (out.family.empty() && !line.nodes.empty()) out.family = family_in_cabinet(line, shell);
  if (out.family.empty()) out.family = line.drive;
  if (out.family.empty() && as_before) out.family = shell.family_in_use();
  if (out.family.empty()) out.family = family_in_cell(line);
  if (out.family.empty()) out.family = family_said_before(line, shell);
  out.turn_said = value_of(words, "--turn", {}).has_value() || cabinet_says_turn(line, shell);
  return out;
}

}  // namespace servoctl::cli
