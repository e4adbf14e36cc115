#include "session/motion_units.hpp"

#include <algorithm>
#include <cmath>

#include "session/measure.hpp"

namespace servoctl::session {

MotionUnits::MotionUnits(Session& session, const drive::Profile& profile, std::uint8_t node,
                         std::optional<double> turn, std::optional<double> encoder)
    : profile_(&profile), node_(node) {
  const MeasureQuestion questions[] = {{node, drive::Measure::increments_per_turn},
                                       {node, drive::Measure::pulses_per_turn},
                                       {node, drive::Measure::rated_torque}};
  const auto answers = read_measures(session, profile, questions);
  for (std::size_t i = 0; i < answers.size(); ++i)
    if (answers[i]) measures_[questions[i].measure] = *answers[i];
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

Result<Bytes> MotionUnits::parse(ObjectAddress object, std::string_view text) const {
  const auto what = meaning(object);
  auto value = drive::parse_quantity(what, text);
  if (!value && what.encoding == od::Encoding::plain) {
    // 250 rpm need not be a whole number of counts a second: for a motion the nearest is as good.
    auto real = what;
    real.type = od::DataType::f64;
    if (const auto number = drive::parse_quantity(real, text)) {
      value = od::Value(static_cast<std::int64_t>(std::llround(od::to_double(*number))));
      if (const auto fits = drive::check_limits(what, *value); !fits)
        return tl::unexpected<Error>(fits.error());
    }
  }
  if (!value) {
    auto error = value.error();
    if (what.measure == drive::Measure::increments_per_turn && !what.bridge)
      error.hint += "; --turn COUNTS says it";
    return fail(std::move(error));
  }
  return od::encode(what.type, *value);
}

std::optional<Physical> MotionUnits::physical(ObjectAddress object, ByteSpan bytes) const {
  const auto what = meaning(object);
  const auto value = what.type_known ? od::decode(what.type, bytes) : Result<od::Value>(od::Value());
  if (!what.type_known || !value) return std::nullopt;
  if (const auto familiar = drive::familiar(what, *value))
    if (what.unit != "%") return Physical{familiar->value, std::string(familiar->unit)};
  return Physical{drive::scaled(what, *value), std::string(what.unit)};
}

Result<Physical> MotionUnits::parse_physical(ObjectAddress object, std::string_view text) const {
  const auto data = parse(object, text);
  if (!data) return tl::unexpected<Error>(data.error());
  return physical(object, *data).value_or(Physical{});
}

std::optional<Bytes> MotionUnits::bytes(ObjectAddress object, double value) const {
  const auto what = meaning(object);
  if (!what.type_known) return std::nullopt;
  const auto one = od::encode(
      what.type, what.encoding == od::Encoding::plain
                     ? od::Value(std::int64_t{1})
                     : od::encode_number(what.encoding, what.type, 1).value_or(od::Value(std::int64_t{0})));
  const auto step = one ? physical(object, *one) : std::nullopt;
  if (!step || step->value == 0) return std::nullopt;
  double raw = value / step->value;
  const auto limit = [&](const std::optional<od::Value>& bound) {
    return what.encoding == od::Encoding::plain ? od::to_double(*bound)
                                                : od::decode_number(what.encoding, *bound);
  };
  if (what.min) raw = std::max(raw, limit(what.min));
  if (what.max) raw = std::min(raw, limit(what.max));
  const auto number = what.encoding == od::Encoding::plain
                          ? Result<od::Value>(od::Value(static_cast<std::int64_t>(std::llround(raw))))
                          : od::encode_number(what.encoding, what.type, raw);
  const auto data = number ? od::encode(what.type, *number) : tl::unexpected<Error>(number.error());
  return data ? std::optional(*data) : std::nullopt;
}

std::string MotionUnits::unit(ObjectAddress object) const {
  const auto what = meaning(object);
  const auto size = what.type_known ? od::size_of(what.type).value_or(4) : 4;
  const auto zero = physical(object, Bytes(size, 0));
  return zero ? zero->unit : std::string();
}

std::optional<ObjectAddress> MotionUnits::object(std::string_view name) const {
  if (name.empty()) return std::nullopt;
  const auto target = drive::resolve(profile_, name);
  if (!target) return std::nullopt;
  return target->address;
}

}  // namespace servoctl::session
