#include "drive/quantity.hpp"

#include <fmt/format.h>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/number.hpp"
#include "base/text.hpp"

namespace servoctl::drive {
namespace {

enum class Dimension : std::uint8_t {
  time,
  speed,
  ratio,
  frequency,
  pulse_rate,
  voltage,
  current,
  torque,
  power,
  angle,
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
    Unit{"rpm", Dimension::speed, 1},
    Unit{"rev/s", Dimension::speed, 60},
    Unit{"r/min", Dimension::speed, 1},
    Unit{"rad/s", Dimension::speed, 30 / kPi},
    Unit{"deg/s", Dimension::speed, 1. / 6},
    Unit{"%", Dimension::ratio, 1},
    Unit{"‰", Dimension::ratio, 0.1},
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
    Unit{"deg", Dimension::angle, 1. / 360},
    Unit{"rad", Dimension::angle, 0.5 / kPi},
    Unit{"rev", Dimension::angle, 1},
    Unit{"degC", Dimension::temperature, 1},
};

const Unit* find_unit(std::string_view name) {
  for (const auto& unit : kUnits)
    if (unit.name == name) return &unit;
  for (const auto& unit : kUnits)
    if (equals_nocase(unit.name, name)) return &unit;
  return nullptr;
}

/// Splits `60rpm` and `1.5 rev/s`; empty when the text does not begin with a number or nothing follows it.
struct NumberWithUnit {
  double number = 0;
  std::string_view unit;
};
std::optional<NumberWithUnit> split_unit(std::string_view text) {
  NumberWithUnit out;
  const auto* begin = text.data() + (!text.empty() && text.front() == '+' ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, text.data() + text.size(), out.number);
  if (error != std::errc{}) return std::nullopt;
  out.unit = trim(text.substr(static_cast<std::size_t>(stop - text.data())));
  return out.unit.empty() ? std::nullopt : std::optional(out);
}

/// The double nearest to the decimal number with 12 significant digits: takes the noise of 400 × 0.1 away.
double tidy(double value) { return parse_real(fmt::format("{:.12g}", value)).value_or(value); }

Result<od::Value> from_physical(const Meaning& meaning, const NumberWithUnit& given, std::string_view text) {
  const auto* unit = find_unit(given.unit);
  const auto* own = find_unit(meaning.unit);
  const bool same = equals_nocase(given.unit, meaning.unit) && !meaning.unit.empty();
  if (meaning.unit.empty())
    return fail(Errc::usage, fmt::format("'{}' carries a unit, but this object has none", text),
                "write the plain number");
  if (!same && (unit == nullptr || own == nullptr || unit->dimension != own->dimension))
    return fail(Errc::usage,
                fmt::format("'{}': the unit of this object is {}, which {} cannot be converted to", text,
                            meaning.unit, given.unit),
                fmt::format("write a value in {} or the raw number", meaning.unit));
  const double physical = same ? given.number : given.number * unit->factor / own->factor;
  const double raw = tidy(physical / meaning.scale);
  if (od::is_real(meaning.type)) return od::Value(raw);
  if (std::abs(raw) > 9.0e18)
    return fail(Errc::usage, fmt::format("'{}' is too large for this object", text));
  if (raw != std::nearbyint(raw))
    return fail(
        Errc::usage,
        fmt::format("'{}' is {:g} steps of {:g} {}: not a whole number", text, raw, meaning.scale,
                    meaning.unit),
        fmt::format("the nearest value is {:g} {}", std::nearbyint(raw) * meaning.scale, meaning.unit));
  return od::parse_value(meaning.type, fmt::format("{:.0f}", raw));
}

const od::EnumLabel* find_label(const Meaning& meaning, std::string_view text) {
  if (meaning.labels == nullptr) return nullptr;
  for (const auto& label : *meaning.labels)
    if (equals_nocase(label.label, text) || (!label.label_zh.empty() && label.label_zh == text))
      return &label;
  return nullptr;
}

std::string labels_text(const Meaning& meaning) {
  std::string out;
  for (const auto& label : *meaning.labels) {
    if (!out.empty()) out += ", ";
    out += fmt::format("{} {}", label.value, label.label);
  }
  return out;
}

}  // namespace

Meaning meaning(const Target& target, std::uint8_t node) {
  Meaning out;
  if (target.parameter != nullptr) {
    const auto& parameter = *target.parameter;
    out.type = parameter.type;
    out.type_known = true;
    out.access = parameter.access;
    out.unit = parameter.unit;
    out.scale = parameter.scale;
    out.min = parameter.min;
    out.max = parameter.max;
    out.labels = parameter.labels.empty() ? nullptr : &parameter.labels;
    out.effect = parameter.effect;
    return out;
  }
  if (target.entry == nullptr) return out;
  const auto& entry = *target.entry;
  out.type = entry.type;
  out.type_known = true;
  out.access = entry.access;
  out.unit = entry.unit;
  out.scale = entry.scale;
  if (entry.low) out.min = entry.low->for_node(node);
  if (entry.high) out.max = entry.high->for_node(node);
  out.labels = entry.labels.empty() ? nullptr : &entry.labels;
  out.effect = entry.effect;
  return out;
}

Result<void> check_limits(const Meaning& meaning, const od::Value& value) {
  const bool low = meaning.min && od::compare_numbers(value, *meaning.min) < 0;
  const bool high = meaning.max && od::compare_numbers(value, *meaning.max) > 0;
  if (!low && !high) return {};
  std::string hint;
  if (meaning.labels != nullptr)
    hint = "values: " + labels_text(meaning);
  else if (meaning.scale != 1)
    hint = fmt::format("one step is {:g} {}", meaning.scale, meaning.unit);
  return fail(Errc::usage, fmt::format("{} is out of range: {}", od::to_string(value), range_text(meaning)),
              std::move(hint));
}

Result<od::Value> parse_quantity(const Meaning& meaning, std::string_view text) {
  text = trim(text);
  auto value = [&]() -> Result<od::Value> {
    if (const auto* label = find_label(meaning, text))
      return od::parse_value(meaning.type, fmt::format("{}", label->value));
    const bool number = od::is_integer(meaning.type) || od::is_real(meaning.type);
    if (number && !parse_integer(text))
      if (const auto physical = split_unit(text)) return from_physical(meaning, *physical, text);
    auto plain = od::parse_value(meaning.type, text);
    if (!plain && meaning.labels != nullptr && !parse_integer(text))
      return fail(Errc::usage, fmt::format("'{}' is no value of this object", text),
                  "values: " + labels_text(meaning));
    return plain;
  }();
  if (!value) return value;
  if (const auto checked = check_limits(meaning, *value); !checked)
    return tl::unexpected<Error>(checked.error());
  return value;
}

double scaled(const Meaning& meaning, const od::Value& value) {
  const double raw = od::to_double(value);
  return meaning.scale == 1 ? raw : tidy(raw * meaning.scale);
}

const od::EnumLabel* label_of(const Meaning& meaning, const od::Value& value) {
  if (meaning.labels == nullptr) return nullptr;
  for (const auto& label : *meaning.labels)
    if (od::compare_numbers(value, od::Value(label.value)) == 0 &&
        !std::holds_alternative<std::string>(value) && !std::holds_alternative<Bytes>(value))
      return &label;
  return nullptr;
}

std::string range_text(const Meaning& meaning) {
  if (meaning.min && meaning.max)
    return fmt::format("{}..{}", od::to_string(*meaning.min), od::to_string(*meaning.max));
  if (meaning.min) return "at least " + od::to_string(*meaning.min);
  if (meaning.max) return "at most " + od::to_string(*meaning.max);
  return {};
}

}  // namespace servoctl::drive
