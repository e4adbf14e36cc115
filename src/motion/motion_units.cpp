#include "motion/motion_units.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/assumed_unit.hpp"
#include "drive/load_unit.hpp"
#include "drive/unit.hpp"
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
constexpr double kDegreesASecond = 6;  ///< Of 1 rpm.
/// In place of what only the drive tells: which units there are does not depend on it.
constexpr double kSomeMeasure = 1000;

/// What people write motions in, the handiest first.
constexpr std::string_view kMotionUnits[] = {"deg",   "rev",   "rad",   "rpm",    "rev/s",
                                             "deg/s", "rad/s", "rpm/s", "rev/s2", "rad/s2",
                                             "%",     "Nm",    "inc",   "inc/s",  "inc/s2"};

bool converts(const drive::Meaning& what, std::string_view unit) {
  return drive::conversion(unit, what.unit) || (what.bridge && drive::conversion(unit, what.bridge->unit));
}

constexpr std::uint16_t kFeedConstant = 0x6092;

/// A feed constant (6092h) tells how many position units a turn has, whatever they are called.
bool is_of_feed(const drive::Quotient& way) {
  const auto objects = way.objects();
  return std::any_of(objects.begin(), objects.end(), [](auto one) { return one.index == kFeedConstant; });
}

/// The object of the drive that would name the unit.
ObjectAddress naming(const drive::Meaning& what) {
  if (what.unit == "inc") return ObjectAddress{0x60A8, 0};
  return what.unit == "inc/s" ? ObjectAddress{0x60A9, 0} : ObjectAddress{0x60AA, 0};
}

/// Where the unit of speeds is found: a drive without a velocity mode has no 60FFh, and limits of a speed are
/// in the unit of its other speeds.
ObjectAddress stated_at(const drive::Profile& profile, ObjectAddress object) {
  if (object != objects::kTargetVelocity || profile.dictionary.find(object) != nullptr) return object;
  for (const auto other : {objects::kProfileVelocity, objects::kHomingSpeedSwitch, objects::kVelocityActual})
    if (profile.dictionary.find(other) != nullptr) return other;
  return object;
}

/// Nothing turns by it, in whatever unit.
bool is_zero(std::string_view text) {
  const auto number = parse_integer(text);
  return number ? number->magnitude == 0 : parse_real(text) == 0;
}

}  // namespace

MotionUnits::MotionUnits(session::Session& session, const drive::Profile& profile, std::uint8_t node,
                         std::optional<double> turn, std::optional<double> encoder,
                         std::optional<double> learned, std::optional<drive::LoadUnit> load)
    : profile_(&profile),
      node_(node),
      own_(std::in_place, session, profile, node),
      unanswered_(own_->unanswered()),
      load_(std::move(load)) {
  const session::MeasureQuestion questions[] = {{node, drive::Measure::increments_per_turn, learned},
                                                {node, drive::Measure::pulses_per_turn},
                                                {node, drive::Measure::rated_torque}};
  const auto answers = session::read_measures(session, profile, questions, &unanswered_);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i]) continue;
    measures_[questions[i].measure] = answers[i]->value;
    const bool of_turn = questions[i].measure == drive::Measure::increments_per_turn;
    if (of_turn && turn && !answers[i]->learned && answers[i]->value != *turn)
      other_turn_ = answers[i]->value;
    if (of_turn && !turn) turn_way_ = answers[i]->way;
    if (of_turn && is_of_feed(*answers[i]->way)) own_->prove_position();
  }
  if (turn) own_->prove_position();
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
  const auto target = drive::target_at(profile_, stated_at(*profile_, object));
  auto out = drive::meaning(target, node_);
  if (own_) own_->apply(target, out);
  if (!out.measure) return out;
  const auto known = measures_.find(*out.measure);
  if (known != measures_.end()) out.bridge = drive::bridge(out.unit, object, known->second);
  return out;
}

bool MotionUnits::is_unproven(ObjectAddress object) const {
  return own_ && !own_->proves(drive::target_at(profile_, stated_at(*profile_, object)));
}

Error MotionUnits::unproven(ObjectAddress object, std::string_view text) const {
  const auto named_by =
      naming(drive::meaning(drive::target_at(profile_, stated_at(*profile_, object)), node_));
  return make_error(
      Errc::usage,
      message("'{}': the unit of {} is not known: neither the drive's data nor the drive ({}) states it",
              as_it_is(text), as_it_is(to_string(object)), to_string(named_by)),
      "write the plain number that the drive takes; its manual gives the unit. A wrong unit can turn the "
      "motor at its maximum speed");
}

std::optional<double> MotionUnits::turn() const {
  const auto known = measures_.find(drive::Measure::increments_per_turn);
  return known == measures_.end() ? std::nullopt : std::optional(known->second);
}

Error MotionUnits::unusable(ObjectAddress object, std::string_view text, const std::string& motor,
                            Error error) const {
  const auto what = meaning(object);
  if (what.measure == drive::Measure::increments_per_turn && !what.bridge)
    error.hint +=
        message("; --turn gives the 6064h increments per revolution{}",
                profile_->rules.learn.speed.empty() ? Message() : Message(", `units learn` measures them"));
  if (motor != text) error.message = message("'{}' of the load: {}", as_it_is(text), error.message);
  return error;
}

Result<void> MotionUnits::check_unit(const drive::Meaning& what, ObjectAddress object, std::string_view text,
                                     std::string_view motor) const {
  if (is_zero(trim(motor))) return {};
  const auto given = drive::split_unit(trim(motor));
  if (given && !parse_integer(trim(motor)) && is_unproven(object)) return fail(unproven(object, text));
  // Without a drive an assumed unit is as good as the plain number.
  if (what.unit.empty() ||
      (!given && !own_ && drive::is_unit_assumed(drive::target_at(profile_, stated_at(*profile_, object)))))
    return {};
  if (given && converts(what, given->unit)) return {};
  std::vector<std::string_view> units;
  const auto of_the_load = of_load(1, unit(object));
  if (of_the_load) units.push_back(of_the_load->unit);
  for (const auto one : kMotionUnits)
    if (converts(what, one)) units.push_back(one);
  if (!converts(what, what.unit) || std::find(units.begin(), units.end(), what.unit) == units.end())
    units.push_back(what.unit);
  auto hint = units.size() == 1 ? formatted("its unit here is {}", units.front())
                                : formatted("its unit here is one of these: {}", fmt::join(units, ", "));
  if (given && !of_the_load && drive::parse_load_unit(formatted("1 {}", given->unit), 1))
    append(hint,
           formatted("as a unit of the load, {} needs `per_turn` of the axis in a cabinet file", given->unit),
           "; ");
  const bool bare = parse_integer(trim(text)) || parse_real(trim(text));
  if (bare) return fail(Errc::usage, message("'{}' has no unit", as_it_is(text)), std::move(hint));
  if (!given)
    return fail(Errc::usage, message("'{}' is not a number with a unit", as_it_is(text)), std::move(hint));
  return fail(Errc::usage,
              message("'{}': {} cannot be converted to {}", as_it_is(text), given->unit, what.unit),
              std::move(hint));
}

Result<Setpoint> MotionUnits::parse(ObjectAddress object, std::string_view text, Kind kind) const {
  const auto what = meaning(object);
  const auto motor = for_motor(text, kind);
  if (const auto told = check_unit(what, object, text, motor); !told)
    return fail(unusable(object, text, motor, told.error()));
  const auto quantity = drive::nearest_quantity(what, motor);
  if (!quantity) return fail(unusable(object, text, motor, quantity.error()));
  auto data = od::encode(what.type, quantity->value);
  if (!data) return fail(data.error());
  Setpoint out{std::move(*data), {}, quantity->rounding ? drive::to_string(*quantity->rounding) : ""};
  out.value = physical(object, out.data).value_or(Physical{});
  return out;
}

std::optional<Physical> MotionUnits::physical(ObjectAddress object, ByteSpan bytes) const {
  const auto what = drive::as_answered(meaning(object), bytes.size());
  const auto value = what.type_known ? od::decode(what.type, bytes) : Result<od::Value>(od::Value());
  if (!what.type_known || !value) return std::nullopt;
  return physical_of(what, *value);
}

Result<Physical> MotionUnits::parse_physical(ObjectAddress object, std::string_view text, Kind kind) const {
  auto what = meaning(object);
  const auto motor = for_motor(text, kind);
  if (const auto told = check_unit(what, object, text, motor); !told)
    return fail(unusable(object, text, motor, told.error()));
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
  if (const auto told = check_unit(what, object, text, motor); !told)
    return fail(unusable(object, text, motor, told.error()));
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

std::optional<double> MotionUnits::rate(ObjectAddress speed) const {
  const auto of_way = unit(objects::kPositionActual);
  const auto of_speed = unit(speed);
  if (of_speed == "rpm" && of_way == "deg") return kDegreesASecond;
  return !of_way.empty() && of_speed == of_way + "/s" ? std::optional(1.) : std::nullopt;
}

double MotionUnits::step(ObjectAddress object) const {
  const auto what = meaning(object);
  if (!what.type_known || !od::is_integer(what.type) || what.encoding != od::Encoding::plain) return 0;
  const auto one = od::encode(what.type, od::Value(std::int64_t{1}));
  const auto step = one ? physical(object, *one) : std::nullopt;
  return step ? std::abs(step->value) : 0;
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
  auto out = number_text(value);
  if (!unit.empty()) out += formatted(" {}", unit);
  if (const auto load = of_load(value, unit))
    out += formatted(" ({} {})", number_text(load->value), load->unit);
  return out;
}

std::optional<ObjectAddress> MotionUnits::object(std::string_view name) const {
  if (name.empty()) return std::nullopt;
  const auto target = drive::resolve(profile_, name);
  if (!target) return std::nullopt;
  return target->address;
}

}  // namespace servoctl::motion
