#include "session/motion.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <new>

#include "drive/soft_ramp.hpp"
#include "drive/standard_objects.hpp"
#include "session/producer_claim.hpp"

namespace servoctl::session {
namespace {

/// A motor at rest shows some noise: this part of the commanded speed, and 3 rpm where it is told in rpm.
constexpr double kNoisePart = 0.02;
constexpr double kNoiseRpm = 3;
/// A motor is run away that turns so much faster than it was told to, and more than its noise.
constexpr double kOverspeed = 1.5;
constexpr double kNoiseOfOverspeed = 5;
constexpr double kDegreesASecond = 6;  ///< Of 1 rpm.
/// What conversions of units may add to a number.
constexpr double kRounding = 1 + 1e-6;

}  // namespace

Motion::Motion(Session& session, const drive::Profile& profile, std::uint8_t node, MotionOptions options)
    : session_(&session),
      profile_(&profile),
      node_(node),
      options_(std::move(options)),
      power_(session, profile, node) {}

Result<void> Motion::prepare() {
  if (const auto alive = power_.statusword(); !alive) return tl::unexpected<Error>(alive.error());
  units_ = std::make_unique<MotionUnits>(*session_, *profile_, node_, options_.turn, options_.encoder);
  monitor_ = std::make_unique<MotionMonitor>(*session_, *units_, node_);
  if (const auto done = read_limits(); !done) return done;
  speed_cap_ = find_speed_cap();
  auto plan = plan_watchdog(*session_, *profile_, node_, options_.producer);
  if (!plan) return tl::unexpected<Error>(plan.error());
  watchdog_ = std::move(*plan);
  return {};
}

Result<void> Motion::read_limits() {
  struct Row {
    Channel channel;
    const std::string* text;
    std::optional<double>* out;
  };
  auto& limits = monitor_->limits();
  for (const auto& row :
       {Row{Channel::torque, &options_.max_torque, &limits.torque},
        Row{Channel::following_error, &options_.max_following_error, &limits.following_error},
        Row{Channel::position, &options_.window, &limits.travel}}) {
    if (row.text->empty()) continue;
    const auto object = object_of(row.channel);
    if (!units_->has(object))
      return fail(Errc::usage,
                  fmt::format("this family does not tell its {} ({})", name(row.channel), to_string(object)),
                  "leave this limit out");
    const auto value = units_->parse_physical(object, *row.text);
    if (!value) return tl::unexpected<Error>(value.error());
    *row.out = std::abs(value->value);
  }
  if (options_.acceleration.empty()) return {};
  const auto ramp = units_->parse(objects::kProfileAcceleration, options_.acceleration);
  return ramp ? Result<void>{} : tl::unexpected<Error>(ramp.error());
}

/// A speed the drive holds, when it is told in the unit of the target velocity.
std::optional<double> Motion::read_speed(ObjectAddress object) {
  if (!units_->has(object) || units_->unit(object) != units_->unit(objects::kTargetVelocity))
    return std::nullopt;
  const auto answer = session_->upload(node_, object);
  const auto value = answer ? units_->physical(object, *answer) : std::nullopt;
  return value && value->value > 0 ? std::optional(value->value) : std::nullopt;
}

Result<double> Motion::find_speed_cap() {
  const auto unit = units_->unit(objects::kTargetVelocity);
  std::optional<double> most;
  for (const auto object : {objects::kMaxProfileVelocity, objects::kMaxMotorSpeed})
    if (const auto speed = read_speed(object)) most = std::min(*speed, most.value_or(*speed));
  if (!options_.speed_limit.empty()) {
    const auto asked = units_->parse_physical(objects::kTargetVelocity, options_.speed_limit);
    if (!asked) return tl::unexpected<Error>(asked.error());
    if (most && std::abs(asked->value) > *most)
      return fail(error(Errc::refused,
                        fmt::format("the limit of {:g} {} is above what the drive allows, {:g} {}",
                                    asked->value, unit, *most, unit),
                        "607Fh and 6080h hold it"));
    return std::abs(asked->value);
  }
  const auto rated = units_->object(rules().rated_speed);
  if (rated)
    if (const auto speed = read_speed(*rated)) most = std::min(*speed, most.value_or(*speed));
  if (unit == "rpm") return std::min(kSafeRpm, most.value_or(kSafeRpm));
  if (most) return *most * kSafePart;
  return fail(Errc::usage, "what speed is safe cannot be told from this drive",
              fmt::format("add --limit SPEED in {}", unit.empty() ? "the drive's own unit" : unit));
}

Result<void> Motion::check_speed(double speed) const {
  if (!speed_cap_) return tl::unexpected<Error>(speed_cap_.error());
  if (std::abs(speed) <= *speed_cap_ * kRounding) return {};
  const auto unit = units_->unit(objects::kTargetVelocity);
  return fail(error(
      Errc::refused,
      fmt::format("{:g} {} is above the limit of {:g} {}", std::abs(speed), unit, *speed_cap_, unit),
      fmt::format("`--limit {:g}{}` raises it, when the machine may move that fast", std::abs(speed), unit)));
}

Result<std::vector<PreflightItem>> Motion::look(bool chinese) {
  return preflight(*session_, *units_, node_, watchdog_, chinese);
}

void Motion::set_standstill(double speed) {
  const bool rpm = units_->unit(objects::kVelocityActual) == "rpm";
  standstill_ = std::max(rpm ? kNoiseRpm : 0, std::abs(speed) * kNoisePart);
  if (guard_) guard_->set_standstill(standstill_);
}

bool Motion::stands_still(const MotionSample& sample) const {
  const auto speed = sample[Channel::velocity];
  return !speed || std::abs(*speed) <= standstill_;
}

bool Motion::supervise_speed(double limit) {
  if (units_->unit(objects::kVelocityActual) != units_->unit(objects::kTargetVelocity)) return false;
  monitor_->limits().speed = limit;
  return true;
}

void Motion::supervise_overspeed(double speed) {
  (void)supervise_speed(std::abs(speed) * kOverspeed + standstill_ * kNoiseOfOverspeed);
}

std::vector<MotionSetting> Motion::ramps(double speed, std::initializer_list<ObjectAddress> objects) const {
  std::vector<MotionSetting> out;
  for (const auto object : objects) {
    if (!units_->has(object)) continue;
    if (!options_.acceleration.empty()) {
      if (const auto data = units_->parse(objects::kProfileAcceleration, options_.acceleration))
        out.emplace_back(object, *data);
      continue;
    }
    const auto ramp =
        drive::soft_ramp(units_->unit(object), units_->unit(objects::kTargetVelocity), speed, kRampSeconds);
    const auto data = ramp ? units_->bytes(object, *ramp) : std::nullopt;
    if (data) out.emplace_back(object, *data);
  }
  return out;
}

std::optional<double> Motion::rate() const {
  const auto of_way = units_->unit(objects::kPositionActual);
  const auto of_speed = units_->unit(objects::kTargetVelocity);
  if (of_speed == "rpm" && of_way == "deg") return kDegreesASecond;
  return of_speed == of_way + "/s" ? std::optional(1.) : std::nullopt;
}

std::optional<Duration> Motion::duration(double way, double speed) const {
  const auto one = rate();
  if (!one || speed == 0) return std::nullopt;
  const double seconds = std::abs(way / (speed * *one)) + 2 * kRampSeconds;
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

Result<void> Motion::look_again() {
  // Answers to other masters that came meanwhile must not be taken for answers to what is asked now.
  if (const auto heard = session_->listen(); !heard) return heard;
  const auto state = power_.state();
  if (!state) return tl::unexpected<Error>(state.error());
  if (drive::is_energised(*state)) return fail(enabled_by_others(node_, *state));
  return {};
}

Result<void> Motion::begin(std::int8_t mode, const std::vector<MotionSetting>& settings,
                           std::optional<ObjectAddress> kept_target) {
  if (const auto ready = look_again(); !ready) return ready;
  if (const auto own = claim_producer(*session_, node_, options_.producer, watchdog_); !own) return own;
  monitor_->find_tpdos();
  guard_ = std::make_unique<MotionGuard>(*session_, *units_, node_);
  guard_->set_standstill(standstill_);
  if (const auto done = guard_->spare_flash(); !done) return done;
  if (const auto done = guard_->arm(watchdog_); !done) return done;
  if (const auto done = guard_->change_mode(mode); !done) return done;
  if (const auto done = guard_->neutral_targets(kept_target); !done) return done;
  for (const auto& [object, data] : settings)
    if (const auto done = guard_->change(object, data); !done) return done;
  if (const auto started = guard_->start_node(); !started) return started;
  (void)session_->take_events();  // What was told before is no news of this motion.
  auto enabled = guard_->enable();
  monitor_->on_written();
  return enabled;
}

Result<void> Motion::write(ObjectAddress object, const Bytes& data) {
  auto done = guard_->change(object, data);
  monitor_->on_written();
  return done;
}

Result<void> Motion::command(std::uint16_t controlword) {
  auto done = power_.command(controlword);
  monitor_->on_written();
  return done;
}

/// What a motion keeps grows with its time.
Result<bool> Motion::watch(const std::function<Result<bool>(const MotionSample&)>& done, Duration longest) {
  try {
    return supervise(done, longest);
  } catch (const std::bad_alloc&) {
    return fail(error(Errc::bug, "the memory ran out, so the motion was ended",
                      "give it more memory, or a shorter motion; end other programs"));
  }
}

Result<bool> Motion::supervise(const std::function<Result<bool>(const MotionSample&)>& done,
                               Duration longest) {
  const auto end = session_->now() + longest;
  for (;;) {
    const auto sample = monitor_->sample();
    if (!monitor_->samples().empty() && options_.on_sample) options_.on_sample(monitor_->samples().back());
    if (!sample) return tl::unexpected<Error>(sample.error());
    if (options_.unheard && options_.unheard())
      return fail(error(Errc::interrupted, "nobody reads the output any more; the motion was ended"));
    const auto enough = done(*sample);
    if (!enough || *enough) return enough;
    if (session_->now() >= end) return false;
    if (const auto waited = monitor_->wait_for_next(); !waited) return tl::unexpected<Error>(waited.error());
  }
}

MotionReport Motion::finish(Result<void> outcome) {
  MotionReport out;
  out.outcome = std::move(outcome);
  out.watchdog = watchdog_;
  out.begun = guard_ != nullptr;
  if (guard_) out.end = guard_->end();
  try {
    out.samples = monitor_->samples();
    out.series = monitor_->series();
  } catch (const std::bad_alloc&) {
    out.samples.clear();
    out.series.clear();
    if (out.outcome) out.outcome = fail(error(Errc::bug, "the memory ran out: there are no samples to show"));
  }
  out.events = monitor_->events();
  out.by_pdo = monitor_->by_pdo();
  return out;
}

}  // namespace servoctl::session
