#include "od/esi_unit.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "base/decade.hpp"
#include "od/esi_value.hpp"

namespace servoctl::od {
namespace {

struct UnitRow {
  std::uint8_t code;
  std::string_view name;
};

/// CiA 303-2, table of units: those that drives have.
constexpr std::array kEsiUnits{
    UnitRow{0x01, "m"},   UnitRow{0x03, "s"},    UnitRow{0x04, "A"},   UnitRow{0x05, "K"},
    UnitRow{0x10, "rad"}, UnitRow{0x20, "Hz"},   UnitRow{0x21, "N"},   UnitRow{0x24, "W"},
    UnitRow{0x26, "V"},   UnitRow{0x2D, "degC"}, UnitRow{0x41, "deg"}, UnitRow{0x47, "min"},
    UnitRow{0x48, "h"},   UnitRow{0x56, "Nm"},   UnitRow{0xB4, "rev"}, UnitRow{0xB5, "inc"},
    UnitRow{0xC0, "rpm"},
};

constexpr std::uint8_t kSecond = 0x03;
constexpr std::uint8_t kMinute = 0x47;
constexpr std::uint8_t kSquareSecond = 0x57;
constexpr std::uint8_t kRevolution = 0xB4;

/// `rpm` for revolutions per minute, `rev/s`, `inc/s2`; empty when it is not known.
std::string unit_name(std::uint8_t numerator, std::uint8_t denominator) {
  if (numerator == kRevolution && denominator == kMinute) return "rpm";
  for (const auto& row : kEsiUnits) {
    if (row.code != numerator) continue;
    if (denominator == 0) return std::string(row.name);
    if (denominator == kSecond) return std::string(row.name) + "/s";
    if (denominator == kSquareSecond) return std::string(row.name) + "/s2";
  }
  return {};
}

/// The powers of ten that people have a letter for.
std::string_view prefix_of(int power) {
  return power == -6 ? "u" : power == -3 ? "m" : power == 3 ? "k" : "";
}

bool takes_prefix(std::string_view unit) {
  constexpr std::array<std::string_view, 8> kTakers{"m", "s", "A", "Hz", "N", "W", "V", "Nm"};
  return std::find(kTakers.begin(), kTakers.end(), unit) != kTakers.end();
}

}  // namespace

std::optional<EsiUnit> esi_unit(std::string_view text) {
  if (text.empty()) return std::nullopt;
  const auto number = esi_integer(text);
  if (!number) return EsiUnit{std::string(text), 1};
  if (number->negative || number->magnitude > 0xFFFF'FFFF) return std::nullopt;
  return si_unit(static_cast<std::uint32_t>(number->magnitude));
}

std::optional<EsiUnit> si_unit(std::uint32_t code) {
  const auto power = static_cast<std::int8_t>(code >> 24U);
  auto name = unit_name(static_cast<std::uint8_t>(code >> 16U), static_cast<std::uint8_t>(code >> 8U));
  if (name.empty()) return std::nullopt;
  if (const auto prefix = prefix_of(power); !prefix.empty() && takes_prefix(name))
    return EsiUnit{std::string(prefix) + name, 1};
  return EsiUnit{std::move(name), power_of_ten(power)};
}

}  // namespace servoctl::od
