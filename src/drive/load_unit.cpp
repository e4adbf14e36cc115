#include "drive/load_unit.hpp"

#include <array>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/unit.hpp"

namespace servoctl::drive {
namespace {

/// Millimetres in one of it; empty for another word.
std::optional<double> length(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 5> kLengths{
      {{"um", 1e-3}, {"mm", 1}, {"cm", 10}, {"m", 1e3}, {"in", 25.4}}};
  for (const auto& [name, millimetres] : kLengths)
    if (name == unit) return millimetres;
  return std::nullopt;
}

/// What follows a length or an angle in a speed and in an acceleration.
constexpr std::array<std::string_view, 3> kPerTime{"", "/s", "/s2"};

}  // namespace

Result<LoadUnit> parse_load_unit(std::string_view text, double gear) {
  const auto given = split_unit(trim(text));
  if (!given)
    return fail(Errc::usage, message("'{}' is not a number with the load's unit", as_it_is(trim(text))),
                "write how far the load moves in one turn of the gear's output: \"20 mm\"");
  const auto [number, unit] = *given;
  for (const auto own : {"rev", "rpm", "rev/s2", "inc", "%", "Nm", "s", "Hz", "V", "A", "W", "degC"})
    if (conversion(unit, own))
      return fail(Errc::usage, message("'{}' is a unit of the motor or of time", as_it_is(unit)),
                  "a rotating load needs a unit of another name: \"360 tabledeg\"");
  if (number == 0 || unit.find_first_of("/ ,;=\"'") != std::string_view::npos)
    return fail(Errc::usage, message("'{}' is not a distance of the load", as_it_is(trim(text))),
                "such as \"20 mm\"; -20 for a load that runs the other way");
  return LoadUnit{std::string(unit), number / gear};
}

std::optional<std::string> in_revolutions(const LoadUnit& load, std::string_view text) {
  const auto given = split_unit(trim(text));
  if (!given) return std::nullopt;
  const auto [number, unit] = *given;
  for (const auto per : kPerTime) {
    if (!unit.ends_with(per)) continue;
    const auto what = unit.substr(0, unit.size() - per.size());
    const auto from = length(what);
    const auto to = length(load.unit);
    if (what != load.unit && (!from || !to)) continue;
    const double ratio = what == load.unit ? 1 : *from / *to;
    return formatted("{}rev{}", plain_number(number * ratio / load.per_rev, 15), per);
  }
  return std::nullopt;
}

std::optional<std::string> size_in_revolutions(const LoadUnit& load, std::string_view text) {
  return in_revolutions({load.unit, std::abs(load.per_rev)}, text);
}

std::optional<LoadValue> of_load(const LoadUnit& load, double value, std::string_view unit) {
  for (const auto per : kPerTime)
    if (const auto revolutions = conversion(unit, formatted("rev{}", per)))
      return LoadValue{value * *revolutions * load.per_rev, formatted("{}{}", load.unit, per)};
  return std::nullopt;
}

}  // namespace servoctl::drive
