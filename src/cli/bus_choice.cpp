#include "cli/bus_choice.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/format.hpp"
#include "base/text.hpp"
#include "cli/axis_lines.hpp"
#include "session/open_bus.hpp"

namespace servoctl::cli {
namespace {

using cabinet::Axis;
using cabinet::Cabinet;

/// The axes that the nodes of the settings name; none where they are numbers.
std::vector<const Axis*> axes_in(const Cabinet& cabinet, const Settings& settings) {
  if (!names_axes(settings.nodes)) return {};
  return cabinet.select(settings.nodes).value_or(std::vector<const Axis*>());
}

}  // namespace

void add_once(std::vector<Message>& notices, Message notice) {
  if (std::find(notices.begin(), notices.end(), notice) == notices.end())
    notices.push_back(std::move(notice));
}

const cabinet::Bus* bus_given(const Cabinet& cabinet, const std::string& bus) {
  if (const auto* named = cabinet.bus(bus)) return named;
  const auto url = session::canonical_url(bus);
  const auto found = std::find_if(cabinet.buses.begin(), cabinet.buses.end(), [&](const cabinet::Bus& one) {
    return session::canonical_url(one.url) == url;
  });
  return found == cabinet.buses.end() ? nullptr : &*found;
}

Result<Settings> settle_bus(const Cabinet& cabinet, Settings settings, std::vector<Message>& notices) {
  const auto bus_from = settings.bus_from;
  if (settings.bus.empty() || settings.cabinet_from == Source::folder || settings.cabinet_from < bus_from)
    return settings;
  const auto* known = bus_given(cabinet, settings.bus);
  if (settings.cabinet_from > bus_from) {
    const bool numbers = !settings.nodes.empty() && !equals_nocase(settings.nodes, "all");
    if (known != nullptr && known->name == settings.bus && numbers) return settings;
    if (known == nullptr || cabinet.buses.size() > 1)
      add_once(notices,
               message("{} ({}) is not used: the buses are those of {} ({})", name_of(bus_from, "--bus"),
                       as_it_is(settings.bus), as_it_is(cabinet.file.string()),
                       name_of(settings.cabinet_from, "--cabinet")));
    settings.bus.clear();
    return settings;
  }
  if (known != nullptr) settings.bus = known->name;
  // At the prompt the word `bus` comes later than the file.
  if (known != nullptr || bus_from == Source::set) return settings;
  std::vector<std::string> names;
  for (const auto& bus : cabinet.buses) names.push_back(formatted("{} ({})", bus.name, bus.url));
  return fail(Errc::usage,
              message("{} has no bus {}: {} and {} contradict each other", as_it_is(cabinet.file.string()),
                      as_it_is(settings.bus), name_of(bus_from, "--bus"),
                      name_of(settings.cabinet_from, "--cabinet")),
              message("its buses: {}; leave one of the two out", NameList{names}));
}

bool are_on_bus(const Cabinet& cabinet, const Settings& settings) {
  const auto axes = axes_in(cabinet, settings);
  const auto* bus = bus_given(cabinet, settings.bus);
  return settings.bus.empty() || std::all_of(axes.begin(), axes.end(), [&](const Axis* axis) {
           return bus != nullptr && axis->bus == bus->name;
         });
}

bool are_of_family(const Cabinet& cabinet, const Settings& settings) {
  const auto axes = axes_in(cabinet, settings);
  return settings.drive.empty() || std::all_of(axes.begin(), axes.end(), [&](const Axis* axis) {
           return axis->family == settings.drive;
         });
}

}  // namespace servoctl::cli
