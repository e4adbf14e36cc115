#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/time.hpp"
#include "drive/profile.hpp"
#include "drive/quantity.hpp"
#include "sim/homing.hpp"
#include "sim/object_values.hpp"
#include "sim/track.hpp"

namespace servoctl::sim {

/// Ways in which the mechanics misbehave; all off at first.
struct AxisFaults {
  bool stalled = false;   ///< The motor cannot turn: the following error grows.
  bool reversed = false;  ///< It turns the other way.
  double lag = 0;         ///< Seconds by which it is behind its command.
  Duration late_start{};  ///< Homing begins so long after it was told, and "homed" stands until then.
};

/// The moving part of a simulated drive: profile position with its set-points, profile velocity, torque and
/// homing, in the units of the family's own objects. It moves by trapezoid ramps and without load, past the
/// switches of its track. Positions are in units of 6064h, speeds in those units a second.
class Axis {
 public:
  Axis(const drive::Profile& profile, ObjectValues& values)
      : profile_(&profile),
        values_(&values),
        switch_rules_(find_switch_rules()),
        encoder_(find_encoder()),
        speed_monitor_(find_speed_monitor()),
        own_counts_(default_counts()) {}

  /// What the power stage lets it do.
  enum class Drive : std::uint8_t {
    released,  ///< No torque: it is taken to stand still at once.
    stopping,  ///< To rest by the ramp of begin_stop(), and held there, whatever its targets say.
    obeying,   ///< Operation enabled.
  };

  /// Power-on: at rest, nothing homed, no set-point.
  void reset(TimePoint now);
  /// A controlword, after the power stage has taken it.
  void on_controlword(std::uint16_t controlword, Drive drive, TimePoint now);
  /// Interpolated position, where the family takes its points at SYNC: 60C1h:01 is the next one.
  void take_point();
  /// Lets time pass and puts position, speed and torque into their objects.
  void advance(Drive drive, TimePoint now);
  /// From now on Drive::stopping slows down by this object's ramp, or by drive::kMostTorque. The time that
  /// takes.
  Duration begin_stop(const std::string& ramp);

  /// Bits 10 to 15 of the statusword while the drive is enabled; else what lasts of them: homed, at a limit,
  /// following error.
  std::uint16_t bits(bool enabled) const;

  bool is_moving() const { return velocity_ != 0 && !faults_.stalled; }
  /// The following error was greater than 6065h for 6066h, where a mode follows a position (CiA 402-2); until
  /// clear_error().
  bool has_following_error() const { return following_error_; }
  void clear_error() { following_error_ = false; }
  AxisFaults& faults() { return faults_; }
  /// Whether no object gives the counts per revolution: the family's rules say `learned`, or nothing.
  bool has_own_counts() const;
  /// Counts per revolution where has_own_counts().
  double& own_counts() {
    shown_.reset();
    return own_counts_;
  }
  Track& track() {
    shown_.reset();
    return track_;
  }
  /// Values of parameters that have no object and can be set on the panel only, by their name.
  std::map<std::string, std::int64_t, std::less<>>& panel() { return panel_; }

 private:
  enum class Kind : std::uint8_t {
    none,
    position,
    velocity,
    torque,
    homing,
    interpolated,
    cyclic,  ///< Of position.
    cyclic_velocity,
    cyclic_torque
  };
  /// Of 6064h; infinite where nothing limits it.
  struct Range {
    double least;
    double greatest;
  };

  Kind kind() const;
  bool controls_position() const;
  bool is_halted() const;
  bool is_active() const;  ///< Bit 4 of the controlword, in interpolated position.
  bool is_full() const;
  void take_setpoint(bool relative, bool at_once);
  void start_homing();
  void home(double seconds);
  bool is_steady() const;
  bool has_settled() const;
  void step(double seconds);
  void obey(double seconds);
  void approach(double wanted_velocity, double seconds);
  void show_torque(double acceleration);
  double rated_torque() const;
  double most_torque() const;
  void step_position(double seconds);
  bool interpolates_at_sync() const { return profile_->rules.motion.interpolation_ms.size() == 2; }
  void step_to_point(double seconds);
  Duration interpolation_period() const;
  /// Where it follows a position at once, without set-points: the object; empty where it does not.
  std::optional<ObjectAddress> followed() const;
  void follow();
  void follow_point();
  Range limits() const;
  double allowed(double wanted) const;
  bool is_at_limit() const;
  void watch_window();
  void travel(double seconds);
  void publish();
  void publish(double here);
  /// What publish() makes its numbers of, besides track and counts.
  struct Shown {
    double position;
    double origin;
    double turning;
    double torque;
    double behind;
    double lag;
    std::uint64_t values;
    bool operator==(const Shown&) const = default;
  };
  Shown shown() const {
    return {position_, origin_, turning(), torque_, behind_, faults_.lag, values_->changes()};
  }
  const drive::Meaning& meaning_of(ObjectAddress object) const;
  void write(ObjectAddress object, double value);
  double read(ObjectAddress object) const;
  /// Where the axis stands on its track.
  double place() const { return (position_ - origin_) / units_per_turn(); }
  /// A caution that masks switches, and where its parameters stand; empty: on the panel only.
  struct SwitchRule {
    const drive::Caution* rule = nullptr;
    std::vector<std::pair<std::string, std::optional<ObjectAddress>>> parameters;
  };
  std::vector<SwitchRule> find_switch_rules() const;
  bool holds(const SwitchRule& rule) const;
  bool holds(const drive::Caution& rule, const std::string& name, std::optional<ObjectAddress> object) const;
  void look_at_switch_rules();
  ObjectAddress find_encoder() const;
  std::optional<ObjectAddress> find_speed_monitor() const;
  double per_turn(drive::Measure measure) const;
  bool states_no_counts() const;  ///< Neither its data nor an object gives the counts of a turn.
  double default_counts() const;
  double units_per_turn() const;
  double fastest_by_torque() const;                 ///< What the family's limits leave in torque mode.
  ObjectAddress speed_object() const;               ///< Holds the speed of a move to a position.
  double speed_factor(ObjectAddress object) const;  ///< One of the object's speed unit in units a second.
  double ramp(ObjectAddress object) const;          ///< Units a second a second.
  static constexpr double kNoRamp = 1e12;           ///< The speed changes at once.
  double ramp() const;                              ///< The one of the present mode, or of a stop.
  double turning() const;                           ///< The speed of the motor itself.
  std::uint16_t position_bits() const;
  std::uint16_t homing_bits() const;
  std::uint16_t velocity_bits() const;
  std::uint16_t following_bits(ObjectAddress target) const;
  std::uint16_t bits_of_mode() const;

  const drive::Profile* profile_;
  ObjectValues* values_;
  std::vector<SwitchRule> switch_rules_;
  std::map<std::string, std::int64_t, std::less<>> panel_;
  ObjectAddress encoder_;
  std::optional<ObjectAddress> speed_monitor_;  ///< Shows the speed of the motor in rpm.
  TimePoint time_{};
  std::uint16_t controlword_ = 0;
  double position_ = 0;
  double origin_ = 0;  ///< 6064h where the axis stood at power-on.
  double velocity_ = 0;
  double torque_ = 0;  ///< In the unit of 6077h.
  Drive drive_ = Drive::released;
  double stop_ramp_ = 0;  ///< Units a second a second.
  std::optional<double> target_;
  std::deque<double> waiting_;
  bool acknowledged_ = false;  ///< Bit 12 in profile position.
  bool at_once_ = false;       ///< The present set-point gives way to a new one at once.
  bool homed_ = false;
  bool was_homed_ = false;  ///< Before the present run.
  Homing homing_;
  unsigned homings_ = 0;
  double behind_ = 0;                   ///< Demand minus actual position.
  std::optional<TimePoint> out_since_;  ///< Since when that is out of its window.
  bool following_error_ = false;
  AxisFaults faults_;
  Track track_;
  double own_counts_;
  std::optional<double> point_;  ///< The last one taken at SYNC since bit 4 was set.
  TimePoint point_due_{};        ///< When it is to be reached.
  std::optional<Shown> shown_;   ///< When the objects were last written; empty where they have to be.
  mutable std::unordered_map<ObjectAddress, drive::Meaning> meanings_;  ///< Those asked for so far.
};

}  // namespace servoctl::sim
