#include "motion/motion_units.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "base/number.hpp"
#include "session/measure.hpp"

namespace servoctl::motion {

namespace {

Physical physical_of(const drive::Meaning& what, const od::Value& value) {
  if (const auto familiar = drive::familiar(what, value))
    if (what.unit != "%") return {familiar->value, std::string(familiar->unit)};
  return {drive::scaled(what, value), std::string(what.unit)};
}

/// Whole numbers beyond it have no double of their own.
constexpr double kMostSteps = 9.0e15;
/// In place of what only the drive tells: which units there are does not depend on it.
constexpr double kSomeMeasure = 1000;

}  // namespace

MotionUnits::MotionUnits(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                         std::optional<double> turn, std::optional<double> encoder,
                         std::optional<double> learned, std::optional<drive::LoadUnit> load)
    : profile_(&profile), node_(node), load_(std::move(load)) {
  const session::MeasureQuestion questions[] = {{node, drive::Measure::increments_per_turn, learned},
                                                {node, drive::Measure::pulses_per_turn},
                                                {node, drive::Measure::rated_torque}};
  const auto answers = session::read_measures(session, profile, questions);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i]) continue;
    measures_[questions[i].measure] = answers[i]->value;
    if (questions[i].measure == drive::Measure::increments_per_turn && !turn) turn_way_ = answers[i]->way;
  }
  tell(turn, encoder);
}

MotionUnits::MotionUnits(const drive::Profile& profile, std::uint8_t node, std::optional<double> turn,
                         std::optional<double> encoder, std::optional<drive::LoadUnit> load)
    : profile_(&profile), node_(node), load_(std::move(load)) {
  tell(turn, encoder);
}

void MotionUnits::tell(std::optional<double> turn, std::optional<double> encoder) {
  if (turn) measures_[drive::Measure::increments_per_turn] = *turn;
  if (encoder) measures_[drive::Measure::pulses_per_turn] = *encoder;
}

bool MotionUnits::has(ObjectAddress object) const { return profile_->dictionary.find(object) != nullptr; }

drive::Meaning MotionUnits::meaning(ObjectAddress object) const {
  auto out = drive::meaning(drive::target_at(profile_, object), node_);
  if (!out.measure) return out;
  const auto known = measures_.find(*out.measure);
  if (known != measures_.end()) out.bridge = drive::bridge(out.unit, object, known->second);
  return out;
}

std::optional<double> MotionUnits::turn() const {
  const auto known = measures_.find(drive::Measure::increments_per_turn);
  return known == measures_.end() ? std::nullopt : std::optional(known->second);
}

Error MotionUnits::unusable(ObjectAddress object, std::string_view text, const std::string& motor,
                            Error error) const {
  const auto what = meaning(object);
  if (what.measure == drive::Measure::increments_per_turn && !what.bridge)
    error.hint += fmt::format("; --turn gives the 6064h increments per revolution{}",
                              profile_->rules.learn.speed.empty() ? "" : ", `units learn` measures them");
  if (motor != text) error.message = fmt::format("'{}' of the load: {}", text, error.message);
  return error;
}

Result<Setpoint> MotionUnits::parse(ObjectAddress object, std::string_view text, Kind kind) const {
  const auto what = meaning(object);
  const auto motor = for_motor(text, kind);
  const auto quantity = drive::nearest_quantity(what, motor);
  if (!quantity) return fail(unusable(object, text, motor, quantity.error()));
  auto data = od::encode(what.type, quantity->value);
  if (!data) return fail(data.error());
  Setpoint out{std::move(*data), {}, quantity->rounding ? drive::to_string(*quantity->rounding) : ""};
  out.value = physical(object, out.data).value_or(Physical{});
  return out;
}

std::optional<Physical> MotionUnits::physical(ObjectAddress object, ByteSpan bytes) const {
  const auto what = meaning(object);
  const auto value = what.type_known ? od::decode(what.type, bytes) : Result<od::Value>(od::Value());
  if (!what.type_known || !value) return std::nullopt;
  return physical_of(what, *value);
}

Result<Physical> MotionUnits::parse_physical(ObjectAddress object, std::string_view text, Kind kind) const {
  auto what = meaning(object);
  const auto motor = for_motor(text, kind);
  auto value = drive::parse_quantity(what, motor);
  if (!value && what.encoding == od::Encoding::plain && od::is_integer(what.type)) {
    what.type = od::DataType::f64;
    if (auto between = drive::parse_quantity(what, motor)) value = std::move(between);
  }
  if (!value) return fail(unusable(object, text, motor, value.error()));
  return physical_of(what, *value);
}

Result<double> MotionUnits::check(ObjectAddress object, std::string_view text, Kind kind,
                                  bool between) const {
  auto what = meaning(object);
  const bool unknown = what.measure && !what.bridge;
  if (unknown) what.bridge = drive::bridge(what.unit, object, kSomeMeasure);
  if ((unknown || between) && what.encoding == od::Encoding::plain && od::is_integer(what.type)) {
    what.type = od::DataType::f64;
    what.least.reset();
    if (unknown) what.min = what.max = std::nullopt;
  }
  const auto motor = for_motor(text, kind);
  const auto quantity = drive::nearest_quantity(what, motor);
  if (!quantity) return fail(unusable(object, text, motor, quantity.error()));
  return drive::scaled(what, quantity->value);
}

std::optional<Bytes> MotionUnits::bytes(ObjectAddress object, double value) const {
  const auto what = meaning(object);
  if (!what.type_known || !std::isfinite(value)) return std::nullopt;
  const bool plain = what.encoding == od::Encoding::plain;
  const auto one = od::encode(
      what.type, plain ? od::Value(std::int64_t{1})
                       : od::encode_number(what.encoding, what.type, 1).value_or(od::Value(std::int64_t{0})));
  const auto step = one ? physical(object, *one) : std::nullopt;
  if (!step || step->value == 0) return std::nullopt;
  double raw = value / step->value;
  if (plain && raw != 0 && std::abs(raw) < 1) raw = std::copysign(1, raw);
  const auto limit = [&](const std::optional<od::Value>& bound) {
    return plain ? od::to_double(*bound) : od::decode_number(what.encoding, *bound);
  };
  if (what.min) raw = std::max(raw, limit(what.min));
  if (what.max) raw = std::min(raw, limit(what.max));
  if (plain && std::abs(raw) > kMostSteps) return std::nullopt;
  const auto number = plain ? Result<od::Value>(od::Value(static_cast<std::int64_t>(std::llround(raw))))
                            : od::encode_number(what.encoding, what.type, raw);
  const auto data = number ? od::encode(what.type, *number) : fail(number.error());
  return data ? std::optional(*data) : std::nullopt;
}

std::string MotionUnits::unit(ObjectAddress object) const {
  const auto what = meaning(object);
  const auto size = what.type_known ? od::size_of(what.type).value_or(4) : 4;
  const auto zero = physical(object, Bytes(size, 0));
  return zero ? zero->unit : std::string();
}

std::string MotionUnits::for_motor(std::string_view text, Kind kind) const {
  if (!load_) return std::string(text);
  const auto turned =
      kind == Kind::way ? drive::in_revolutions(*load_, text) : drive::size_in_revolutions(*load_, text);
  return turned.value_or(std::string(text));
}

std::optional<Physical> MotionUnits::of_load(double value, std::string_view unit) const {
  const auto load = load_ ? drive::of_load(*load_, value, unit) : std::nullopt;
  return load ? std::optional(Physical{load->value, load->unit}) : std::nullopt;
}

std::string MotionUnits::words(double value, std::string_view unit) const {
  auto out = fmt::format("{} {}", number_text(value), unit);
  if (const auto load = of_load(value, unit))
    out += fmt::format(" ({} {})", number_text(load->value), load->unit);
  return out;
}

std::optional<ObjectAddress> MotionUnits::object(std::string_view name) const {
  if (name.empty()) return std::nullopt;
  const auto target = drive::resolve(profile_, name);
  if (!target) return std::nullopt;
  return target->address;
}

}  // namespace servoctl::motion
