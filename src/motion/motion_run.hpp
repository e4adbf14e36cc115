#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "motion/motion_kinds.hpp"
#include "show/desk.hpp"

namespace servoctl::motion {

/// What is wanted of a motion beside the motion itself.
struct MotionRequest {
  std::uint8_t node = 0;
  MotionOptions options;
  std::string csv;    ///< The samples go into this file; empty: into none.
  bool plot = false;  ///< Draw the samples over time at the end.
};

/// What a command does between the looks and the answer.
struct MotionRun {
  std::function<Result<MotionPlan>(Motion&)> plan;
  std::function<MotionReport(Motion&, const MotionPlan&)> run;
  bool in_counts = false;  ///< In the drive's own counts, whatever is known of a turn.
};

/// One of the motions of motion/motion_kinds.hpp; `kind` must outlive it.
template <class Kind>
MotionRun motion_run(const Kind& kind, Result<MotionPlan> (*plan)(Motion&, const Kind&),
                     MotionReport (*run)(Motion&, const Kind&, const MotionPlan&)) {
  return {[&kind, plan](Motion& motion) { return plan(motion, kind); },
          [&kind, run](Motion& motion, const MotionPlan& planned) { return run(motion, kind, planned); }};
}

/// Whether the motion could be made as it is asked for: options, units, limits of the drive. Only
/// reads; what an unreachable drive would say is left to the motion itself.
Result<void> check_motion(const show::Desk& desk, const MotionRequest& request,
                          const std::function<Result<MotionPlan>(Motion&)>& plan);

/// Shows cautions that a drive tells in OP only, and asks. `desk` outlives the answer.
AskAgain ask_again(show::Desk& desk, std::uint8_t node);

/// Looks, shows the pre-flight list, asks, moves, and tells how the drive was left. With --dry-run the drive
/// is looked at and nothing is written.
Result<report::Value> run_motion(show::Desk& desk, const MotionRequest& request, const MotionRun& run);

}  // namespace servoctl::motion
