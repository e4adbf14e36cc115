#include "drive/unit.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "base/text.hpp"

namespace servoctl::drive {
namespace {

enum class Dimension : std::uint8_t {
  time,
  angle,
  speed,
  acceleration,
  ratio,
  ratio_rate,
  frequency,
  pulse_rate,
  voltage,
  current,
  torque,
  power,
  temperature
};

struct Unit {
  std::string_view name;
  Dimension dimension;
  double factor;  ///< One of this unit in the base unit of its dimension.
};

constexpr double kPi = 3.14159265358979323846;

constexpr std::array kUnits{
    Unit{"us", Dimension::time, 1e-6},
    Unit{"ms", Dimension::time, 1e-3},
    Unit{"s", Dimension::time, 1},
    Unit{"min", Dimension::time, 60},
    Unit{"h", Dimension::time, 3600},
    Unit{"deg", Dimension::angle, 1},
    Unit{"rad", Dimension::angle, 180 / kPi},
    Unit{"rev", Dimension::angle, 360},
    Unit{"rpm", Dimension::speed, 1},
    Unit{"r/min", Dimension::speed, 1},
    Unit{"rev/s", Dimension::speed, 60},
    Unit{"rad/s", Dimension::speed, 30 / kPi},
    Unit{"deg/s", Dimension::speed, 1. / 6},
    Unit{"rpm/s", Dimension::acceleration, 1},
    Unit{"rev/s2", Dimension::acceleration, 60},
    Unit{"rad/s2", Dimension::acceleration, 30 / kPi},
    Unit{"deg/s2", Dimension::acceleration, 1. / 6},
    Unit{"%", Dimension::ratio, 1},
    Unit{"‰", Dimension::ratio, 0.1},
    Unit{"%/s", Dimension::ratio_rate, 1},
    Unit{"Hz", Dimension::frequency, 1},
    Unit{"kHz", Dimension::frequency, 1e3},
    Unit{"pps", Dimension::pulse_rate, 1},
    Unit{"kpps", Dimension::pulse_rate, 1e3},
    Unit{"mV", Dimension::voltage, 1e-3},
    Unit{"V", Dimension::voltage, 1},
    Unit{"mA", Dimension::current, 1e-3},
    Unit{"A", Dimension::current, 1},
    Unit{"mNm", Dimension::torque, 1e-3},
    Unit{"Nm", Dimension::torque, 1},
    Unit{"W", Dimension::power, 1},
    Unit{"kW", Dimension::power, 1e3},
    Unit{"degC", Dimension::temperature, 1},
};

struct Familiar {
  Dimension dimension;
  std::string_view unit;
};
constexpr std::array kFamiliar{Familiar{Dimension::angle, "deg"}, Familiar{Dimension::speed, "rpm"},
                               Familiar{Dimension::acceleration, "rpm/s"}};

const Unit* find_unit(std::string_view name) {
  for (const auto& unit : kUnits)
    if (unit.name == name) return &unit;
  for (const auto& unit : kUnits)
    if (equals_nocase(unit.name, name)) return &unit;
  return nullptr;
}

}  // namespace

std::optional<double> conversion(std::string_view from, std::string_view to) {
  if (!from.empty() && equals_nocase(from, to)) return 1;
  const auto* given = find_unit(from);
  const auto* wanted = find_unit(to);
  if (given == nullptr || wanted == nullptr || given->dimension != wanted->dimension) return std::nullopt;
  return given->factor / wanted->factor;
}

std::optional<NumberWithUnit> split_unit(std::string_view text) {
  NumberWithUnit out;
  const bool plus = !text.empty() && text.front() == '+';
  if (plus && text.size() > 1 && text[1] == '-') return std::nullopt;
  const auto* begin = text.data() + (plus ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, text.data() + text.size(), out.number);
  if (error != std::errc{} || !std::isfinite(out.number)) return std::nullopt;
  out.unit = trim(text.substr(static_cast<std::size_t>(stop - text.data())));
  return out.unit.empty() ? std::nullopt : std::optional(out);
}

std::string_view familiar_unit(std::string_view unit) {
  const auto* known = unit.empty() ? nullptr : find_unit(unit);
  if (known == nullptr) return {};
  for (const auto& row : kFamiliar)
    if (row.dimension == known->dimension && conversion(unit, row.unit) != 1) return row.unit;
  return {};
}

}  // namespace servoctl::drive
