#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/series.hpp"
#include "motion/motion_units.hpp"
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
  TimePoint time;
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

  MotionMonitor(session::Session& session, const MotionUnits& units, std::uint8_t node);

  MotionLimits& limits() { return limits_; }
  /// From now on what TPDOs bring is not read by SDO. Reads the drive's mapping (where it does not tell it,
  /// and once the mapping no longer holds, everything is read) and the COB-ID of its emergencies.
  void find_tpdos();
  /// The drive was told something: what it said before is no answer to it.
  void on_written() { told_at_ = session_->now(); }
  /// How many values TPDOs have brought.
  std::size_t by_pdo() const { return by_pdo_; }

  /// Takes one sample, of values that TPDOs brought in the last period, and reads the others; then the drive
  /// must be "operation enabled", within its limits, and silent about errors. Errc::timeout when it does not
  /// answer, Errc::negative with the reason to stop otherwise.
  Result<MotionSample> sample();
  /// Lets the rest of the period pass.
  Result<void> wait_for_next();

  /// The position may jump because the drive gives it a new zero: what one of speed goes in a second, in the
  /// unit of the position, tells a jump from a way. Jumps are no travel.
  void expect_new_zero(double rate) { rate_ = rate; }

  const std::vector<MotionSample>& samples() const { return samples_; }
  /// What the node told meanwhile.
  const std::vector<session::NodeEvent>& events() const { return events_; }
  /// One quantity each, of those the drive tells; time from the first sample on.
  std::vector<Series> series() const;

 private:
  std::optional<Series> of_load(const Series& motor) const;
  void follow_zero(const MotionSample& sample);
  std::vector<Result<Bytes>> look(std::span<const ObjectAddress> objects);
  void tell_end_of_tpdos();
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
  std::optional<double> rate_;   ///< Where the zero may change.
};

}  // namespace servoctl::motion
