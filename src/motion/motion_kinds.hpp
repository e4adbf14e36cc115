#pragma once

#include <algorithm>

#include "motion/motion.hpp"
#include "motion/turn_estimate.hpp"

/// The ways in which servoctl moves a motor. Each checks what it is asked before anything is written
/// (plan_…: only reads), and then runs to its verified end (run_…). A plan belongs to the Motion it was made
/// with.
namespace servoctl::motion {

/// What a person holds down.
enum class HoldKey : std::uint8_t { none, plus, minus, stop };

/// Without a key held for so long nobody is there any more.
inline constexpr Duration kLongestWithoutKey = std::chrono::seconds(5);

/// Part of the commanded speed that counts as turning.
inline constexpr double kTurningPart = 0.1;
/// So many samples in a row that turn the wrong way are no noise.
inline constexpr int kWrongLooks = 3;
inline constexpr double kDegreesATurn = 360;

/// Turning at a speed: for a time, for a way, or while a key is held. One of the three.
struct Jog {
  std::string speed;  ///< Of 60FFh; the sign is the direction.
  std::optional<Duration> length;
  std::optional<double> turns;
  std::function<HoldKey()> keys;
};

/// Going to a position.
struct Move {
  std::string target;  ///< Of 607Ah.
  bool relative = false;
  std::string speed;  ///< Empty: a fifth of the safe speed.
};

/// Finding the home position.
struct Home {
  std::string method;               ///< Of 6098h; empty: the drive's present one.
  std::string fast;                 ///< Of 6099h:01; empty: the drive's present one.
  std::string slow;                 ///< Of 6099h:02; empty: the drive's present one.
  std::string offset;               ///< Of 607Ch; empty: the drive's present one.
  std::optional<Duration> longest;  ///< Empty: by the way it may take, else kLongestHoming.
};
/// Time for homing where nothing tells how far it may go.
inline constexpr Duration kLongestHoming = std::chrono::seconds(60);

/// Pushing with a torque; MotionOptions::speed_limit must be set.
struct Torque {
  std::string torque;  ///< Of 6071h.
  Duration length{};
};

/// Measuring how many counts a turn of the motor has, where no object tells it.
struct Learn {
  /// Of the motor, by the drive's own monitor; the sign is the direction. Were a monitor's scale ten times
  /// what the data says, it would still be the speed that needs no --limit.
  double rpm = 30;
  Duration length = std::chrono::seconds(6);  ///< Of the measurement, at that speed.
  ObjectAddress monitor;                      ///< Shows the speed of the motor in rpm.
  std::string monitor_name;
  double least = 0;  ///< drive::LearnRules::least
  double gear = 1;   ///< Increments of 6064h in one of the counts that are measured.
  TurnExpectation expected;
};
inline constexpr double kLeastLearnRpm = 15;
inline constexpr double kMostLearnRpm = 30;

/// What came of it.
struct LearnReport {
  MotionReport motion;
  std::optional<TurnMeasurement> measured;
  std::optional<TurnCounts> counts;  ///< Empty unless all went well, the end of the motion included.
};

/// What a motion will do: the mode, what is written before it is enabled, and numbers for the message.
struct MotionPlan {
  std::int8_t mode = 0;
  std::vector<MotionSetting> settings;
  std::optional<ObjectAddress> kept_target;  ///< Limits the speed here, so it is not set to zero.
  std::vector<MotionSetting>
      moving;                  ///< What it is told once it is enabled, in order, for those who ask before.
  Bytes command;               ///< Speed, position or torque as it is written.
  double value = 0;            ///< The same as a number; the method in homing.
  std::optional<double> from;  ///< Where a move begins, in the unit of 6064h.
  std::string unit;
  double speed = 0;     ///< In the unit of 60FFh; 0 where it is not known.
  double way = 0;       ///< In the unit of 6064h.
  Duration longest{};   ///< Of homing.
  std::string summary;  ///< `turn at 60 rpm for 2 s`
  std::vector<std::string> notes;

  /// Adds a note, unless it is empty or said already.
  void tell(std::string note) {
    if (!note.empty() && std::find(notes.begin(), notes.end(), note) == notes.end())
      notes.push_back(std::move(note));
  }
};

/// A speed that nobody gave, of a drive of which nothing tells what it is in rpm.
Error unproven_speed(const Motion& motion);

Result<MotionPlan> plan_jog(Motion& motion, const Jog& jog);
MotionReport run_jog(Motion& motion, const Jog& jog, const MotionPlan& plan);

Result<MotionPlan> plan_move(Motion& motion, const Move& move);
MotionReport run_move(Motion& motion, const Move& move, const MotionPlan& plan);

Result<MotionPlan> plan_home(Motion& motion, const Home& home);
MotionReport run_home(Motion& motion, const Home& home, const MotionPlan& plan);

Result<MotionPlan> plan_learn(Motion& motion, const Learn& learn);
LearnReport run_learn(Motion& motion, const Learn& learn, const MotionPlan& plan);

Result<MotionPlan> plan_torque(Motion& motion, const Torque& torque);
MotionReport run_torque(Motion& motion, const Torque& torque, const MotionPlan& plan);

}  // namespace servoctl::motion
