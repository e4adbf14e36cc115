#include "sim/homing.hpp"

#include <cmath>

namespace servoctl::sim {
namespace {

/// The drive gives up after it (bit 13 of the statusword).
constexpr Duration kLongest = std::chrono::seconds(50);
/// A switch is looked at through the filter of its input, so that no run ends between two process data.
constexpr Duration kFilterTime = std::chrono::milliseconds(10);
/// Methods without motion take so long.
constexpr Duration kSettleTime = std::chrono::milliseconds(300);
}  // namespace

void Homing::start(std::int64_t method, Speeds speeds, TimePoint begins) {
  const auto known = drive::homing_method(method);
  phase_ = known || drive::stays_put(method) ? Phase::waiting : Phase::failed;
  method_ = known.value_or(drive::HomingMethod{});
  speeds_ = speeds;
  direction_ = 0;
  turned_ = false;
  begins_ = begins;
}

void Homing::stop() {
  if (is_running()) phase_ = Phase::idle;
}

double Homing::speed() const {
  switch (phase_) {
    case Phase::seek: return direction_ * speeds_.seek;
    case Phase::back:
    case Phase::leave:
    case Phase::enter:
    case Phase::index: return direction_ * speeds_.zero;
    default: return 0;
  }
}

void Homing::go(Phase phase, int direction) {
  phase_ = phase;
  direction_ = direction;
}

void Homing::begin(const Track& track, double place) {
  if (method_.number == 0) return go(Phase::settle, 0);
  if (!method_.input) return seek_pulse(track, place);
  if (track.is_seen(*method_.input, place)) return go(Phase::leave, method_.edge);
  go(Phase::seek, method_.seek);
}

/// On from this place to the next index pulse.
void Homing::seek_pulse(const Track& track, double place) {
  go(Phase::index, method_.approach);
  const double ahead =
      method_.approach > 0 ? std::floor(place - track.index) + 1 : std::ceil(place - track.index) - 1;
  pulse_ = track.no_index ? method_.approach * Track::kFar : ahead + track.index;
}

/// A limit switch that is not the one it looks for stands in its way. While it brakes it is on its way back.
bool Homing::meets_limit(const Track& track, double place) const {
  const auto limit = Track::limit(direction_);
  return speed() != 0 && limit != method_.input && track.is_seen(limit, place);
}

void Homing::turn_or_fail() {
  const bool turns = phase_ == Phase::seek && method_.turns && !turned_;
  if (!turns) return go(Phase::failed, 0);
  turned_ = true;
  direction_ = -direction_;
}

std::optional<double> Homing::look(const Track& track, double place, bool stands, TimePoint now) {
  if (!is_running() || now < begins_ + kFilterTime) return std::nullopt;
  if (phase_ == Phase::waiting) begin(track, place);
  if (now >= begins_ + kLongest) go(Phase::failed, 0);
  if (meets_limit(track, place)) turn_or_fail();
  const bool pressed = method_.input && track.is_seen(*method_.input, place);
  switch (phase_) {
    case Phase::settle: return now >= begins_ + kSettleTime ? find(place) : std::nullopt;
    case Phase::seek:
      if (pressed) phase_ = Phase::brake;
      return std::nullopt;
    case Phase::brake:
      if (stands) go(pressed ? Phase::leave : Phase::back, pressed ? method_.edge : -direction_);
      return std::nullopt;
    case Phase::back:
      if (pressed) go(Phase::leave, method_.edge);
      return std::nullopt;
    case Phase::leave:
      if (pressed) return std::nullopt;
      if (method_.approach == method_.edge) return pass_edge(track);
      go(Phase::enter, method_.approach);
      return std::nullopt;
    case Phase::enter: return pressed ? pass_edge(track) : std::nullopt;
    case Phase::index: return method_.approach * (place - pulse_) >= 0 ? find(pulse_) : std::nullopt;
    default: return std::nullopt;
  }
}

/// The edge is passed slowly and in the right direction: it is home, or the index pulse behind it is.
std::optional<double> Homing::pass_edge(const Track& track) {
  const auto& one = track.at(*method_.input);
  const double edge = (method_.edge < 0 ? one.from : one.to) + track.shift;
  if (!method_.index) return find(edge);
  seek_pulse(track, edge);
  return std::nullopt;
}

std::optional<double> Homing::find(double place) {
  go(Phase::idle, 0);
  return place;
}

}  // namespace servoctl::sim
