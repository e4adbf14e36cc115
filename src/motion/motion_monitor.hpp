#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/series.hpp"
#include "motion/motion_units.hpp"
#include "motion/speed_comparison.hpp"
#include "session/network.hpp"
#include "session/process_values.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// What is measured while a drive moves.
enum class Signal : std::uint8_t { position, velocity, torque, following_error };
inline constexpr std::size_t kSignals = 4;
inline constexpr std::array kEverySignal{Signal::position, Signal::velocity, Signal::torque,
                                         Signal::following_error};
std::string_view name(Signal signal);  ///< `position velocity torque following_error`
ObjectAddress object_of(Signal signal);

/// Longest wait for one answer of a drive that moves: meanwhile nothing is supervised.
inline constexpr Duration kMovingPatience = std::chrono::milliseconds(200);

/// One look at a moving drive. Numbers are in the units of MotionUnits::physical(); one that the drive does
/// not tell is missing.
struct MotionSample {
  TimePoint time;             ///< When the look ended;
  TimePoint begun;            ///< it began then.
  bool is_cut_short = false;  ///< The time was over before all was read.
  std::uint16_t statusword = 0;
  std::array<std::optional<double>, kSignals> values;
  std::optional<double> operator[](Signal signal) const { return values[static_cast<std::size_t>(signal)]; }
};

/// Beyond these the motion is stopped at once; in the units of the samples.
struct MotionLimits {
  std::optional<double> torque;           ///< Of the actual torque, either sign.
  std::optional<double> following_error;  ///< Either sign.
  std::optional<double> travel;           ///< From where the motion began, either way.
  std::optional<double> speed;            ///< Either sign.
};

/// Watches a drive that moves: reads it, listens to what it tells, and says when it must be stopped.
class MotionMonitor {
 public:
  /// Time between two looks; a look takes longer on a slow bus.
  static constexpr Duration kPeriod = std::chrono::milliseconds(20);
  /// A motor that nobody has looked at for so long is stopped: this process stood still, or the link is slow.
  static constexpr Duration kLongestGap = std::chrono::seconds(1);

  MotionMonitor(session::Session& session, const MotionUnits& units, std::uint8_t node);

  MotionLimits& limits() { return limits_; }
  /// From now on what TPDOs bring is not read by SDO. Reads the drive's mapping (where it does not tell it,
  /// and once the mapping no longer holds, everything is read) and the COB-ID of its emergencies.
  void find_tpdos();
  /// The drive was told something: what it said before is no answer to it.
  void on_written() { told_at_ = session_->now(); }
  /// How many values TPDOs have brought.
  std::size_t by_pdo() const { return by_pdo_; }

  /// Takes one sample, of values that TPDOs brought in the last period, and reads the others, as far as that
  /// is done by `end`; then the drive must be "operation enabled", in its mode, within its limits, and silent
  /// about errors; the last look must not be too long ago, and 6064h over time must fit 606Ch. Errc::timeout
  /// when it does not answer, Errc::negative with the reason to stop otherwise.
  Result<MotionSample> sample(TimePoint end);
  /// Lets the rest of the period pass.
  Result<void> wait_for_next();

  /// The position may jump because the drive gives it a new zero: its speed tells a jump from a way. Jumps
  /// are no travel.
  void expect_new_zero() { may_jump_ = true; }
  /// 6061h must show this mode, where the drive has it.
  void expect_mode(std::int8_t mode) { mode_ = mode; }
  /// A motor at rest may show this speed, in the unit of 606Ch.
  void set_noise(double speed) { speeds_.set_noise(speed); }
  /// As SpeedComparison.
  std::optional<double> least_by_position() const { return speeds_.least_by_position(); }
  std::optional<double> by_position() const { return speeds_.by_position(); }
  /// How far the position has gone since the first sample, in its unit, whatever its zero was meanwhile and
  /// wherever 32 bits began anew; empty where the drive does not tell it.
  std::optional<double> way() const;

  const std::vector<MotionSample>& samples() const { return samples_; }
  /// What the node told meanwhile.
  const std::vector<session::NodeEvent>& events() const { return events_; }
  /// One quantity each, of those the drive tells; time from the first sample on.
  std::vector<Series> series() const;

 private:
  std::optional<Series> of_load(const Series& motor) const;
  /// Whether it was a new zero.
  bool follow_zero(const MotionSample& sample);
  void follow(MotionSample& sample);
  bool looks_at_mode() const;
  /// Empty bytes for those that were not asked for because the time was over.
  std::vector<Result<Bytes>> look(std::span<const ObjectAddress> objects, TimePoint end);
  void tell_end_of_tpdos();
  Result<void> check_gap(const MotionSample& sample) const;
  Result<void> check_mode(const Result<Bytes>& answer);
  Result<void> check_speeds() const;
  Result<void> check_events();
  Result<void> check_state(const MotionSample& sample) const;
  Result<void> check_limits(const MotionSample& sample) const;

  session::Session* session_;
  const MotionUnits* units_;
  std::uint8_t node_;
  MotionLimits limits_;
  std::vector<Signal> channels_;  ///< Those the drive has.
  std::unique_ptr<session::ProcessValues> tpdos_;
  std::optional<session::Lifetime> mapping_;  ///< Of what find_tpdos() read, until its end was told.
  TimePoint told_at_{};
  std::size_t by_pdo_ = 0;
  std::vector<MotionSample> samples_;
  std::vector<session::NodeEvent> events_;
  std::optional<double> begin_;  ///< Position of the first sample, seen from the present zero.
  std::optional<double> last_;   ///< Position of the last one, as the drive told it;
  double place_ = 0;             ///< the same without the jumps where 32 bits begin anew.
  double way_by_speed_ = 0;      ///< Since the first sample, by 606Ch.
  std::optional<double> rate_;   ///< Of 606Ch, as MotionUnits::rate().
  double span_ = 0;              ///< After which the position begins anew; 0: never.
  bool may_jump_ = false;        ///< The zero may change.
  int zeros_ = 0;                ///< How often it did.
  std::optional<std::int8_t> mode_;
  TimePoint mode_looked_at_{};
  SpeedComparison speeds_;
};

}  // namespace servoctl::motion
