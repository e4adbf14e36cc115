#include "motion/speed_comparison.hpp"

#include <algorithm>
#include <cmath>

namespace servoctl::motion {
namespace {

/// Over which speeds are compared: longer than drives filter 606Ch.
constexpr Duration kWindow = std::chrono::milliseconds(200);
/// Over which a limit is watched: what it says is a lower bound, whatever the looks took.
constexpr Duration kShortWindow = std::chrono::milliseconds(60);
/// So long both differ before it is no delay of a filter at the end of a ramp.
constexpr Duration kContradiction = std::chrono::milliseconds(300);
constexpr double kMostDifference = 0.5;  ///< Of the greater of the two.
constexpr double kSteps = 2;             ///< By which a position may seem to be off at either end.
constexpr double kTurning = 5;           ///< So many times the noise is a motor that turns.

double seconds(Duration time) { return std::chrono::duration<double>(time).count(); }

}  // namespace

void SpeedComparison::add(TimePoint begun, TimePoint ended, double position, std::optional<double> speed) {
  looks_.push_back({begun, ended, position, speed});
  // One that lies further back than the window is enough.
  while (looks_.size() > 2 && looks_[1].begun <= begun - kWindow) looks_.pop_front();
  if (!differs())
    differs_since_.reset();
  else if (!differs_since_)
    differs_since_ = ended;
}

void SpeedComparison::forget() {
  looks_.clear();
  differs_since_.reset();
}

bool SpeedComparison::is_contradicted() const {
  return differs_since_ && looks_.back().ended - *differs_since_ >= kContradiction;
}

const SpeedComparison::Look* SpeedComparison::look_before(Duration window) const {
  if (looks_.empty()) return nullptr;
  const auto since = looks_.back().begun - window;
  const auto found =
      std::find_if(looks_.rbegin(), looks_.rend(), [&](const Look& look) { return look.begun <= since; });
  return found == looks_.rend() ? nullptr : &*found;
}

std::optional<double> SpeedComparison::least_by_position() const {
  const auto* from = look_before(kShortWindow);
  if (from == nullptr || !rate_) return std::nullopt;
  const auto& to = looks_.back();
  const double way = std::max(0.0, std::abs(to.position - from->position) - kSteps * position_step_);
  return way / seconds(to.ended - from->begun) / *rate_;
}

std::optional<double> SpeedComparison::by_position() const {
  const auto* from = look_before(kShortWindow);
  if (from == nullptr || !rate_) return std::nullopt;
  const auto& to = looks_.back();
  const double time = (seconds(to.ended - from->ended) + seconds(to.begun - from->begun)) / 2;
  return (to.position - from->position) / time / *rate_;
}

bool SpeedComparison::differs_in_kind(double way, double reported) const {
  if (std::abs(reported) <= noise_ * kTurning + speed_step_) return false;
  return way == 0 || (way * reported < 0 && std::abs(way) > kSteps * position_step_);
}

bool SpeedComparison::differs() {
  const auto* from = look_before(kWindow);
  if (from == nullptr) return false;
  const auto& to = looks_.back();
  double sum = 0;
  int count = 0;
  for (const auto& look : looks_) {
    if (!look.speed) continue;
    sum += *look.speed;
    ++count;
  }
  if (count == 0 || !to.speed) return false;
  const double reported = sum / count;
  const double way = to.position - from->position;
  last_reported_ = reported;
  last_by_position_.reset();
  if (!rate_) return differs_in_kind(way, reported);
  const double shortest = std::max(seconds(to.begun - from->ended), seconds(kShortWindow) / 2);
  const double longest = seconds(to.ended - from->begun);
  const double least = std::abs(way) / longest / *rate_;
  const double greatest = std::abs(way) / shortest / *rate_;
  last_by_position_ = std::copysign((least + greatest) / 2, way);
  const bool same_way = way * reported >= 0;
  const double nearest = same_way ? std::clamp(std::abs(reported), least, greatest) : -least;
  const double noise = noise_ + speed_step_ + kSteps * position_step_ / shortest / *rate_;
  const double larger = std::max(std::abs(nearest), std::abs(reported));
  return std::abs(std::abs(reported) - nearest) > kMostDifference * larger + noise;
}

}  // namespace servoctl::motion
