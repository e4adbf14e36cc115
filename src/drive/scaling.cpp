#include "drive/scaling.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace servoctl::drive {
namespace {

struct Row {
  std::string_view unit;
  Measure measure;
  Bridge of_one_turn;  ///< For a measure of 1.
};

constexpr std::array kRows{
    Row{"inc", Measure::increments_per_turn, {"deg", 360}},
    Row{"inc/s", Measure::increments_per_turn, {"rpm", 60}},
    Row{"inc/s2", Measure::increments_per_turn, {"rpm/s", 60}},
    Row{"pulse", Measure::pulses_per_turn, {"deg", 360}},
    Row{"pulse/s", Measure::pulses_per_turn, {"rpm", 60}},
};

/// Objects of CiA 402-2 in per mille of the rated torque (6076h).
constexpr std::array<std::uint16_t, 7> kTorqueObjects{0x6071, 0x6072, 0x6074, 0x6077, 0x60B2, 0x60E0, 0x60E1};

bool is_torque(ObjectAddress object) {
  return std::find(kTorqueObjects.begin(), kTorqueObjects.end(), object.index) != kTorqueObjects.end();
}

const Row* row_of(std::string_view unit) {
  const auto found = std::find_if(kRows.begin(), kRows.end(), [&](const Row& r) { return r.unit == unit; });
  return found == kRows.end() ? nullptr : &*found;
}

}  // namespace

std::vector<ObjectAddress> Quotient::objects() const {
  std::vector<ObjectAddress> out;
  for (const auto* factors : {&multiply, &divide})
    for (const auto& factor : *factors)
      if (const auto* object = std::get_if<ObjectAddress>(&factor)) out.push_back(*object);
  out.insert(out.end(), power_of_two.begin(), power_of_two.end());
  for (const auto& condition : when) out.push_back(condition.object);
  return out;
}

std::optional<Measure> needed_measure(std::string_view unit, ObjectAddress object) {
  if (unit == "%" && is_torque(object)) return Measure::rated_torque;
  const auto* row = row_of(unit);
  return row == nullptr ? std::nullopt : std::optional(row->measure);
}

std::optional<Bridge> bridge(std::string_view unit, ObjectAddress object, double measure) {
  if (measure == 0 || !std::isfinite(measure)) return std::nullopt;
  if (unit == "%" && is_torque(object)) return Bridge{"Nm", measure / 100};
  const auto* row = row_of(unit);
  if (row == nullptr) return std::nullopt;
  return Bridge{row->of_one_turn.unit, row->of_one_turn.factor / measure};
}

}  // namespace servoctl::drive
