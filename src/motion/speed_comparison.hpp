#pragma once

#include <deque>
#include <optional>

#include "base/time.hpp"

namespace servoctl::motion {

/// The speed of a motor by its position (6064h) over time, held against the speed that the drive reports
/// (606Ch): either may be frozen, reversed, or in another unit than the data say. A look takes a while, so
/// what it saw is of some moment of it.
class SpeedComparison {
 public:
  /// One of the speed goes so far in a second, in the unit of the position; empty where their units do not
  /// fit: then only direction and standstill are compared.
  void set_rate(std::optional<double> rate) { rate_ = rate; }
  /// A motor at rest may show this much, in the unit of the speed.
  void set_noise(double noise) { noise_ = noise; }
  /// One count of the position and of the speed, in their units.
  void set_steps(double position, double speed) {
    position_step_ = position;
    speed_step_ = speed;
  }

  /// One look, which began and ended then; `position` without the jump where 32 bits begin anew.
  void add(TimePoint begun, TimePoint ended, double position, std::optional<double> speed);
  /// The position has a new zero: what was seen before does not count.
  void forget();

  /// The least speed by which the position can have changed in the last looks, without a sign, in the unit of
  /// the speed.
  std::optional<double> least_by_position() const;
  /// The speed by position in the middle of what the looks allow.
  std::optional<double> by_position() const;
  /// Both have differed by more than half for a while.
  bool is_contradicted() const;
  /// What was compared last, for a message: by position and as reported; the first is empty where units do
  /// not fit.
  std::optional<double> shown_by_position() const { return last_by_position_; }
  double shown() const { return last_reported_; }

 private:
  struct Look {
    TimePoint begun;
    TimePoint ended;
    double position = 0;
    std::optional<double> speed;
  };
  /// The youngest look that lies so far back; null while there is none.
  const Look* look_before(Duration window) const;
  /// Whether no speed that the looks allow is near the one that was reported.
  bool differs();
  bool differs_in_kind(double way, double reported) const;

  std::optional<double> rate_;
  double noise_ = 0;
  double position_step_ = 0;
  double speed_step_ = 0;
  std::deque<Look> looks_;
  std::optional<TimePoint> differs_since_;
  std::optional<double> last_by_position_;
  double last_reported_ = 0;
};

}  // namespace servoctl::motion
