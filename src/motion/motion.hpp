#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motion/motion_guard.hpp"
#include "motion/motion_monitor.hpp"
#include "motion/preflight.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::motion {

/// What conversions of units may add to a number.
inline constexpr double kUnitRounding = 1 + 1e-6;

/// What a user says about a motion, as it was written: units are known to the drive alone.
struct MotionOptions {
  std::optional<std::uint8_t> producer;  ///< servoctl's own node-ID for the watchdog.
  std::optional<double> turn;            ///< Increments in one turn, where the drive does not tell.
  std::optional<double> learned;         ///< What MotionUnits knows by that name.
  std::optional<drive::LoadUnit> load;   ///< What the load moves, where the user has said it.
  std::optional<double> encoder;         ///< Encoder counts in one turn, where the drive does not tell.
  std::string speed_limit;               ///< Of 60FFh.
  std::string acceleration;              ///< Of 6083h.
  std::string max_torque;                ///< Of 6077h; of a torque to push with as well (6071h).
  std::string max_following_error;       ///< Of 60F4h.
  std::string window;                    ///< Of 6064h.
  std::function<void(const MotionSample&)> on_sample;
  std::filesystem::path state_folder;  ///< Where it is kept what waits for a restart; may be empty.
  /// Increments in one turn that were told for this drive earlier: they decide what speed needs no --limit,
  /// and convert nothing.
  std::optional<double> supposed_turn;
  PanelValues panel;              ///< As they were written, until Motion::prepare().
  bool ignores_remote = false;    ///< As PreflightRequest::ignores_remote.
  bool rehearsal = false;         ///< Nothing is to be sent: the bus is not listened to for a second.
  std::function<bool()> unheard;  ///< Nobody takes the samples any more: the motion ends. May be empty.
  AskAgain ask_again;             ///< About what a drive tells in OP only; empty: it refuses the motion.
};

/// What came of a motion.
struct MotionReport {
  Result<void> outcome;
  bool begun = false;  ///< The drive was touched; else there is no end to tell.
  MotionEnd end;
  WatchdogPlan watchdog;
  std::vector<MotionSample> samples;
  std::vector<Series> series;
  std::vector<session::NodeEvent> events;
  std::size_t by_pdo = 0;                ///< How many values of the samples TPDOs have brought.
  std::vector<std::string> differences;  ///< Where what was measured is not what was asked for.
  std::vector<std::string> unchecked;    ///< What could not be measured.
};

/// An object and what is to be written to it.
using MotionSetting = std::pair<ObjectAddress, Bytes>;

struct MotionPlan;

/// One motion of one drive, from the first look at it to its verified end. Used in this order: prepare(),
/// begin(), then watch() as often as needed, finish().
class Motion {
 public:
  /// Speed that needs no --limit. Where the counts of a turn are not known it is one by those that were told
  /// earlier, else by the fewest that the family's motors have.
  static constexpr double kSafeRpm = 300;
  /// Time in which a motion reaches its speed, and comes to rest, unless told otherwise.
  static constexpr double kRampSeconds = 0.5;

  Motion(session::Session& session, const drive::Profile& profile, std::uint8_t node, MotionOptions options);

  /// Only reads: units, the limits the user gave.
  Result<void> prepare();
  /// What the motion is for: called by plan_…(). Errc::refused, with what to change, where a setting of the
  /// drive makes it impossible: a homing method whose switch the drive ignores.
  Result<void> intend(const Purpose& purpose);
  /// What the drive has stored, and goes by after its next restart.
  show::OwedRestart owed() const;
  /// Which watchdog there is: only reads, and listens for up to kListening. look() and begin() do it as well.
  Result<void> find_watchdog();
  Result<std::vector<PreflightItem>> look(bool chinese);
  /// The part of look() that is about the drive alone.
  Result<std::vector<PreflightItem>> look_at_drive(bool chinese);
  /// What the motion is for, and what was said for its preflight.
  PreflightRequest request() const {
    return {purpose_, options_.panel, options_.ignores_remote, owed(), source_};
  }

  /// Looks once more, because a person may have taken time to answer: Errc::refused when somebody else has
  /// enabled the drive meanwhile. Then arms the watchdog, sets the mode, makes the targets harmless, writes
  /// the settings, and enables.
  Result<void> begin(std::int8_t mode, const std::vector<MotionSetting>& settings,
                     std::optional<ObjectAddress> kept_target = {});
  /// What begin() with this plan, its motion and its end would send; nothing is. Errors as there.
  Result<std::vector<session::PlannedMessage>> rehearse(const MotionPlan& plan);
  /// Writes an object that is put back in the end.
  Result<void> write(ObjectAddress object, const Bytes& data);
  Result<void> command(std::uint16_t controlword);
  /// Samples until `done` says so; false when the time is over first. An error when the motion has to end.
  Result<bool> watch(const std::function<Result<bool>(const MotionSample&)>& done, Duration longest);
  /// Stops the drive, takes its power away, puts everything back.
  MotionReport finish(Result<void> outcome);

  /// The speed in the unit of 60FFh that must not be exceeded: the user's, else a safe one. Errc::usage when
  /// none is known; Errc::refused when the user's is above the drive's own maximum.
  Result<double> speed_cap() const { return speed_cap_; }
  /// The greatest speed that the drive allows (607Fh, 6080h), in the unit of 60FFh; empty where it does not
  /// tell it in that unit. Errors of an answer that was lost.
  Result<std::optional<double>> fastest() const;
  /// Whether nothing tells what a speed is in rpm, not even at worst: then every speed has to be said, and
  /// --limit as well.
  bool is_speed_unproven() const { return speed_unproven_; }
  /// Errc::refused when the speed is above speed_cap().
  Result<void> check_speed(double speed) const;
  /// Stops the motion above this speed, in the unit of 60FFh. False where the drive tells its speed in
  /// another unit: then nothing is supervised.
  bool supervise_speed(double limit);
  /// The same for a motion at this speed: half as fast again, and the noise of a motor, are no reason.
  void supervise_overspeed(double speed);
  /// Puts 6083h and 6084h for this speed, as far as the family has them, into the plan.
  Result<void> add_ramps(double speed, std::initializer_list<ObjectAddress> objects, MotionPlan& plan) const;
  /// Puts a number that servoctl chose, in the unit of MotionUnits::physical(), into the plan, and a note
  /// where the object has to hold quite another one. False where it cannot be said in this object.
  bool add_setting(ObjectAddress object, double value, MotionPlan& plan) const;
  /// The torque in the unit of 6071h that must not be exceeded: MotionOptions::max_torque, else the rated one
  /// or what 6072h leaves of it. Errc::usage when none is known; Errc::refused when the user's is above
  /// 6072h.
  Result<double> torque_cap() const;
  /// What one of speed (60FFh) goes in a second, in the unit of 6064h; empty when their units do not fit.
  std::optional<double> rate() const { return units_->rate(objects::kTargetVelocity); }
  /// Time that the way takes at the speed with its ramps; empty when their units do not fit.
  std::optional<Duration> duration(double way, double speed) const;
  /// What a motor that turns at this speed still shows at rest is found from it.
  void set_standstill(double speed);
  /// The speed is limited by the drive's own monitor in rpm, which needs no counts per turn.
  void limit_by_monitor() { limited_by_monitor_ = true; }
  /// Below this the motor stands still, in the unit of 606Ch.
  bool stands_still(const MotionSample& sample) const;
  double standstill() const { return standstill_; }
  /// After its target became zero. Errc::negative when it is not at rest within this time.
  Result<void> wait_for_rest(Duration longest);
  /// Whether the ramps are those of the user, whose length is not known.
  bool has_own_ramps() const { return !options_.acceleration.empty(); }

  /// Whether the user has said how many counts a turn has, or has it from a measurement.
  bool is_told_turn() const { return options_.turn.has_value() || units_->uses_learned(); }

  const MotionUnits& units() const { return *units_; }
  /// Why the drive may not obey, as look_at_drive() found it.
  const std::optional<OtherSource>& other_source() const { return source_; }
  MotionMonitor& monitor() { return *monitor_; }
  const MotionMonitor& monitor() const { return *monitor_; }
  MotionLimits& limits() { return monitor_->limits(); }
  const drive::MotionRules& rules() const { return profile_->rules.motion; }
  std::uint8_t node() const { return node_; }
  session::Session& session() { return *session_; }
  const WatchdogPlan& watchdog() const { return watchdog_; }
  Error error(Errc code, const Message& what, Message hint = {}) const {
    return drive_error(code, node_, what, std::move(hint));
  }

 private:
  Result<void> check_units_in_force() const;
  Result<bool> supervise(const std::function<Result<bool>(const MotionSample&)>& done, Duration longest);
  Result<void> check_turn(const MotionSample& sample);
  Result<void> check_kept_turn(const MotionSample& sample, double shown);
  Result<std::optional<double>> monitored_speed();
  Error quarrel(double shown, double speed) const;
  Result<void> look_again();
  Result<void> look_in_op();
  Result<void> make_ready(MotionGuard& guard, std::int8_t mode, const std::vector<MotionSetting>& settings,
                          std::optional<ObjectAddress> kept_target, session::Rehearsal& rehearsal);
  Error without_first_axis(Error error) const;
  Result<void> read_limits();
  Result<double> find_speed_cap();
  Result<double> find_unconverted_cap(std::optional<double> most);
  std::optional<double> supposed_turn();
  std::string unconverted_limit() const;
  Result<std::optional<double>> cap_of_cautions(ObjectAddress as, std::string drive::Caution::*text) const;
  /// A limit that the user gave: more than 0, because it holds either way.
  Result<double> parse_limit(ObjectAddress object, std::string_view option, const std::string& text) const;
  /// What an object of the drive says in the unit of `as`, when it can be said so and is above 0.
  Result<std::optional<double>> read_as(ObjectAddress as, ObjectAddress object) const;

  session::Session* session_;
  const drive::Profile* profile_;
  std::uint8_t node_;
  MotionOptions options_;
  Power power_;
  std::optional<OtherSource> source_;
  std::unique_ptr<MotionUnits> units_;
  std::unique_ptr<MotionMonitor> monitor_;
  std::unique_ptr<MotionGuard> guard_;
  WatchdogPlan watchdog_;
  bool watchdog_found_ = false;
  bool chinese_ = false;
  std::vector<PreflightItem> shown_;  ///< What look() has found.
  Result<double> speed_cap_ = 0.0;
  double standstill_ = 0;
  std::optional<Purpose> purpose_;
  bool speed_unproven_ = false;
  bool limited_by_monitor_ = false;
  std::optional<double>
      supposed_turn_;               ///< Increments by which kSafeRpm was converted, for want of known ones.
  std::string turn_unchecked_;      ///< Why the counts of a turn were not held against the monitor.
  std::optional<double> told_rpm_;  ///< The speed of this motion, where it is told in rpm; above 0.
  int fast_looks_ = 0;              ///< In a row, at which the monitor showed a motor that turns too fast.
  int odd_looks_ = 0;  ///< In a row, at which the monitor of the speed contradicted the counts of a turn.
};

}  // namespace servoctl::motion
