#include "command/cabinet_options.hpp"

#include <map>
#include <span>

#include "settings/selection.hpp"

namespace servoctl::command {
namespace {

/// What one axis needs; an error is the axis' own.
Result<void> fill(Context& context, const cabinet::Cabinet& cabinet,
                  std::map<std::string, Result<session::Session*>>& opened, cabinet::Station& station) {
  const auto& axis = *station.axis;
  const auto profile = context.front_end->family(axis.family);
  if (!profile) return fail(profile.error());
  station.profile = *profile;
  auto bus = opened.find(axis.bus);
  if (bus == opened.end())
    bus = opened.emplace(axis.bus, context.front_end->open_bus(cabinet, *cabinet.bus(axis.bus))).first;
  if (!bus->second) return fail(bus->second.error());
  station.session = *bus->second;
  return {};
}

/// A part of the settings that no family of these axes has is a slip of the pen.
Result<void> check_part(std::span<const cabinet::Station> stations, std::string_view part) {
  Result<void> out;
  for (const auto& station : stations) {
    if (station.profile == nullptr) continue;
    const auto known = settings::selection_of(*station.profile, part);
    if (known) return {};
    if (out) out = fail(known.error());
  }
  return out;
}

}  // namespace

Result<std::vector<const cabinet::Axis*>> chosen_axes(const cabinet::Cabinet& cabinet,
                                                      const Arguments& arguments) {
  return cabinet.select(arguments.has("--axis") ? arguments.text("--axis") : "all");
}

Result<std::vector<cabinet::Station>> open_stations(Context& context, const cabinet::Cabinet& cabinet,
                                                    const Arguments& arguments) {
  const auto axes = chosen_axes(cabinet, arguments);
  if (!axes) return fail(axes.error());
  std::vector<cabinet::Station> out;
  std::map<std::string, Result<session::Session*>> opened;
  for (const auto* axis : *axes) {
    out.push_back({axis});
    if (const auto there = fill(context, cabinet, opened, out.back()); !there)
      out.back().away = there.error();
  }
  if (const auto known = check_part(out, arguments.text("--only")); !known) return fail(known.error());
  return out;
}

cabinet::Station open_station(Context& context, const cabinet::Cabinet& cabinet, const cabinet::Axis& axis) {
  std::map<std::string, Result<session::Session*>> opened;
  cabinet::Station out{&axis};
  if (const auto there = fill(context, cabinet, opened, out); !there) out.away = there.error();
  return out;
}

}  // namespace servoctl::command
