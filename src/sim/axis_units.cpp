// The numbers of a simulated axis in the units of the family's own objects.
#include <algorithm>
#include <cmath>
#include <limits>

#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"
#include "sim/axis.hpp"

namespace servoctl::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Where the manual does not tell the counts of a turn, or the factory has left them at one.
constexpr double kAssumedTurn = 10000;
/// Where they can only be measured: 17 bits.
constexpr double kLearnedTurn = 131072;
/// Speed that ramps given as a time lead to.
constexpr double kRampSpeedRpm = 3000;
/// Beyond it nothing can be written.
constexpr double kMostSteps = 9e15;

}  // namespace

const drive::Meaning& Axis::meaning_of(ObjectAddress object) const {
  const auto known = meanings_.find(object);
  if (known != meanings_.end()) return known->second;
  return meanings_.emplace(object, drive::meaning(drive::target_at(profile_, object), 0)).first->second;
}

double Axis::read(ObjectAddress object) const {
  const auto& meaning = meaning_of(object);
  if (!meaning.type_known) return 0;
  const auto value = od::decode(meaning.type, values_->in_force(object));
  return value ? drive::scaled(meaning, *value) : 0;
}

void Axis::write(ObjectAddress object, double number) {
  const auto& meaning = meaning_of(object);
  if (!meaning.type_known) return;
  const auto raw = meaning.encoding == od::Encoding::plain
                       ? Result<od::Value>(od::Value(static_cast<std::int64_t>(
                             std::llround(std::clamp(number / meaning.scale, -kMostSteps, kMostSteps)))))
                       : od::encode_number(meaning.encoding, meaning.type, number);
  const auto bytes = raw ? od::encode(meaning.type, *raw) : fail(raw.error());
  if (bytes) values_->set(object, *bytes);
}

double Axis::fastest_by_torque() const {
  double out = std::numeric_limits<double>::infinity();
  for (const auto& name : profile_->rules.motion.speed_limit) {
    const auto target = drive::resolve(profile_, name);
    if (!target) continue;
    const double limit = std::abs(read(target->address) * speed_factor(target->address));
    if (limit > 0) out = std::min(out, limit);
  }
  return out;
}

ObjectAddress Axis::speed_object() const {
  const auto target = drive::resolve(profile_, profile_->rules.motion.position_speed);
  return target ? target->address : objects::kProfileVelocity;
}

ObjectAddress Axis::find_encoder() const {
  const auto target = drive::resolve(profile_, profile_->rules.motion.encoder);
  return target ? target->address : objects::kInternalPosition;
}

std::optional<ObjectAddress> Axis::find_speed_monitor() const {
  const auto& shown = profile_->rules.motion.speed_monitor;
  const auto& name = shown.empty() ? profile_->rules.learn.speed : shown;
  const auto target = drive::resolve(profile_, name);
  return !name.empty() && target ? std::optional(target->address) : std::nullopt;
}

bool Axis::states_no_counts() const {
  return profile_->rules.units.count(drive::Measure::increments_per_turn) == 0;
}

bool Axis::has_own_counts() const {
  if (states_no_counts()) return meaning_of(objects::kPositionActual).unit != "rad";
  const auto& ways = profile_->rules.units.at(drive::Measure::increments_per_turn);
  return std::any_of(ways.begin(), ways.end(), [](const auto& way) { return way.learned; });
}

double Axis::default_counts() const { return states_no_counts() ? kAssumedTurn : kLearnedTurn; }

double Axis::units_per_turn() const {
  if (meaning_of(objects::kPositionActual).unit == "rad") return 2 * kPi;
  return per_turn(drive::Measure::increments_per_turn);
}

double Axis::per_turn(drive::Measure measure) const {
  const auto rule = profile_->rules.units.find(measure);
  if (rule == profile_->rules.units.end()) return states_no_counts() ? own_counts_ : kAssumedTurn;
  const auto& ways = rule->second;
  const auto holds = [&](const drive::Quotient& way) {
    return std::all_of(way.when.begin(), way.when.end(), [&](const drive::Quotient::When& condition) {
      return load_le(values_->in_force(condition.object)) == condition.value;
    });
  };
  const auto factor = [&](const drive::Quotient::Factor& f) {
    const auto* object = std::get_if<ObjectAddress>(&f);
    return object != nullptr ? read(*object) : std::get<double>(f);
  };
  const auto value_of = [&](const drive::Quotient& way) {
    double out = way.learned ? own_counts_ : 1;
    for (const auto& f : way.multiply) out *= factor(f);
    for (const auto& f : way.divide) out /= factor(f);
    for (const auto object : way.power_of_two) out = std::ldexp(out, static_cast<int>(read(object)));
    return out;
  };
  const bool none = std::none_of(ways.begin(), ways.end(), holds);
  for (const auto& way : ways) {
    if (!holds(way) && !(none && &way == &ways.front())) continue;
    const double out = value_of(way);
    if (std::isfinite(out) && out > 1) return out;
  }
  return kAssumedTurn;
}

double Axis::speed_factor(ObjectAddress object) const {
  const auto unit = meaning_of(object).unit;
  return unit == "rpm" ? units_per_turn() / 60 : 1;
}

double Axis::ramp(ObjectAddress object) const {
  const auto unit = meaning_of(object).unit;
  const double held = read(object);
  const double value = held == 0 ? profile_->rules.motion.zero_ramp : held;
  if (value <= 0) return kNoRamp;
  if (unit == "ms") return kRampSpeedRpm / 60 * units_per_turn() / (value / 1000);
  return unit == "rpm/s" ? value * units_per_turn() / 60 : value;
}

/// The ramps of cyclic modes are the master's.
double Axis::ramp() const {
  if (drive_ == Drive::stopping) return stop_ramp_;
  if (kind() == Kind::cyclic_velocity) return kNoRamp;
  const bool own =
      kind() == Kind::homing && profile_->dictionary.find(objects::kHomingAcceleration) != nullptr;
  return ramp(own ? objects::kHomingAcceleration : objects::kProfileAcceleration);
}

}  // namespace servoctl::sim
