#pragma once

#include <span>
#include <string>
#include <vector>

#include "cabinet/axis_plan.hpp"
#include "cabinet/station.hpp"

namespace servoctl::cabinet {

/// What came of the look at one axis.
struct PlannedAxis {
  const Axis* axis = nullptr;
  Result<AxisPlan> plan;
  std::vector<Message> notices;
  bool to_do() const { return plan && plan->different > 0; }
  bool waits_for_restart() const { return plan && !plan->owed.empty(); }
};

/// Looks at all axes at the same time; what one axis or its bus is not able to tell does not stop the others.
/// PDOs that would come to share a CAN-ID are refused, for the axis that would get it. Of an axis at which an
/// apply was cut off Errc::refused, unless `resume`: then only those are looked at, for what was to be
/// written.
std::vector<PlannedAxis> look_at_all(const show::Desk& desk, const Cabinet& cabinet,
                                     std::span<const Station> stations, const PlanChoice& choice,
                                     bool resume = false);

/// What is to be done, axis by axis, as text and for JSON `{cabinet, axes[{axis node bus family differences
/// unlisted needs error}], different}`.
report::Record plan_record(const Cabinet& cabinet, std::span<const PlannedAxis> looks);

/// Errors and notices of all looks, with the names of their axes.
void tell_looks(show::Desk& desk, std::span<const PlannedAxis> looks);

/// The error, and the notice, with the name of the axis where its node is meant.
Error of_axis(const Axis& axis, Error error);
Message of_axis(const Axis& axis, const Message& notice);

bool any_to_do(std::span<const PlannedAxis> looks);
/// The exit code 1 of a plan by which there is something to do: to write, or to restart.
Error something_to_do(const Cabinet& cabinet, std::span<const PlannedAxis> looks);

/// Where the values of an axis from before an apply are kept, unless that has those of another drive (see
/// settings::BeforeFile); beside the cabinet file.
std::filesystem::path before_file(const Cabinet& cabinet, const Axis& axis);
/// What was to be written to it, beside that for which its values from before are in `before`.
std::filesystem::path wanted_file(const Cabinet& cabinet, const Axis& axis,
                                  const std::filesystem::path& before);

}  // namespace servoctl::cabinet
