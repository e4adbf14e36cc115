#pragma once

#include <algorithm>
#include <array>
#include <functional>

#include "commands/duration_option.hpp"
#include "session/motion_kinds.hpp"

/// What jog, move, home and torque have in common on the command line, and how they run.
namespace servoctl::commands {

inline constexpr Parameter kAccelerationOption{
    .name = "--accel", .help = "ramps (6083h, 6084h) instead of half a second", .kind = Kind::value};
inline constexpr Parameter kTurnOption{
    .name = "--turn",
    .help = "increments of 6064h in one turn of the motor, if the drive does not tell",
    .kind = Kind::number};
/// What every motion takes.
inline constexpr std::array kMotionOptions{
    Parameter{
        .name = "--limit", .help = "greatest speed; raises the safe one knowingly", .kind = Kind::value},
    Parameter{.name = "--max-torque",
              .help = "stop above this torque; the ceiling of `torque`",
              .kind = Kind::value},
    Parameter{
        .name = "--max-following-error", .help = "stop above this following error", .kind = Kind::value},
    Parameter{.name = "--window", .help = "stop when it has moved farther than this", .kind = Kind::value},
    kTurnOption,
    Parameter{
        .name = "--master-node", .help = "servoctl's own node-ID for the watchdog", .kind = Kind::number},
    Parameter{.name = "--plot", .help = "draw the samples over time at the end", .kind = Kind::flag},
};
inline constexpr Parameter kCsvOption{
    .name = "--csv", .help = "write the samples to this file", .kind = Kind::file};

/// The parameters of a motion command: its own, then what every motion takes.
template <std::size_t N>
constexpr std::array<Parameter, N + kMotionOptions.size()> with_motion_options(
    const std::array<Parameter, N>& own) {
  std::array<Parameter, N + kMotionOptions.size()> out{};
  std::copy(kMotionOptions.begin(), kMotionOptions.end(), std::copy(own.begin(), own.end(), out.begin()));
  return out;
}

/// The options above, as far as they are given. Errc::usage for a number that is none.
Result<session::MotionOptions> motion_options(const Context& context, const Arguments& arguments);

/// The one node that a motion may have. Errc::usage for several: one motor at a time.
Result<std::uint8_t> one_node(const Context& context);

/// What a command does between the looks and the answer.
struct MotionRun {
  std::function<Result<session::MotionPlan>(session::Motion&)> plan;
  std::function<session::MotionReport(session::Motion&, const session::MotionPlan&)> run;
  bool in_counts = false;  ///< In the drive's own counts, whatever is known of a turn.
};

/// One of the motions of session/motion_kinds.hpp; `kind` must outlive it.
template <class Kind>
MotionRun motion_run(const Kind& kind, Result<session::MotionPlan> (*plan)(session::Motion&, const Kind&),
                     session::MotionReport (*run)(session::Motion&, const Kind&,
                                                  const session::MotionPlan&)) {
  return {[&kind, plan](session::Motion& motion) { return plan(motion, kind); },
          [&kind, run](session::Motion& motion, const session::MotionPlan& planned) {
            return run(motion, kind, planned);
          }};
}

/// Whether the motion could be made as it is asked for: options, units, limits of the drive. Only
/// reads; what an unreachable drive would say is left to the motion itself.
Result<void> check_motion(const Context& context, const Arguments& arguments,
                          const std::function<Result<session::MotionPlan>(session::Motion&)>& plan);

/// Looks, shows the pre-flight list, asks, moves, and tells how the drive was left. With --dry-run the drive
/// is looked at and nothing is written.
Result<report::Value> run_motion(Context& context, const Arguments& arguments, const MotionRun& run);

}  // namespace servoctl::commands
