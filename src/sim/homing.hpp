#pragma once

#include <cstdint>
#include <optional>

#include "base/time.hpp"
#include "drive/homing_method.hpp"
#include "sim/track.hpp"

namespace servoctl::sim {

/// The homing of a simulated drive, from its start to home or to an error: it says how fast the axis shall
/// go, and looks at switches and index pulse as it goes. Places are in turns of the motor.
class Homing {
 public:
  struct Speeds {
    double seek = 0;  ///< 6099h:01
    double zero = 0;  ///< 6099h:02
  };

  /// Begins at `begins`. Methods that take the present position (35, 37) and 0 need no motion; one that is
  /// unknown is an error. Speeds in any unit, for speed().
  void start(std::int64_t method, Speeds speeds, TimePoint begins);
  /// Interrupted by the master.
  void stop();
  /// The axis has come to this place, and stands there or goes on. Gives the place of home once it is found.
  std::optional<double> look(const Track& track, double place, bool stands, TimePoint now);
  /// The speed that is wanted now, with its sign.
  double speed() const;

  bool is_running() const { return phase_ != Phase::idle && phase_ != Phase::failed; }
  /// It was told to start, and does not do so yet.
  bool is_waiting(TimePoint now) const { return is_running() && now < begins_; }
  bool has_failed() const { return phase_ == Phase::failed; }

 private:
  enum class Phase : std::uint8_t {
    idle,
    failed,
    waiting,  ///< Until it begins.
    settle,   ///< At rest, then home is where the axis stands.
    seek,     ///< Fast, until the switch is pressed.
    brake,    ///< Down to rest, perhaps past the switch.
    back,     ///< Slowly back onto the switch.
    leave,    ///< Slowly off the switch over the edge.
    enter,    ///< Slowly onto it again over the same edge.
    index,    ///< Slowly on to the index pulse.
  };
  void begin(const Track& track, double place);
  void go(Phase phase, int direction);
  void seek_pulse(const Track& track, double place);
  bool meets_limit(const Track& track, double place) const;
  void turn_or_fail();
  std::optional<double> pass_edge(const Track& track);
  std::optional<double> find(double place);

  Phase phase_ = Phase::idle;
  drive::HomingMethod method_;
  Speeds speeds_;
  int direction_ = 0;
  bool turned_ = false;
  TimePoint begins_{};
  double pulse_ = 0;  ///< Place of the index pulse ahead; infinite when none comes.
};

}  // namespace servoctl::sim
