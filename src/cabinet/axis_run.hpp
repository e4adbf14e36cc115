#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "cabinet/cabinet_plan.hpp"
#include "settings/restoring.hpp"

namespace servoctl::cabinet {

/// How an apply ended for one axis.
enum class AxisEnd : std::uint8_t {
  untouched,      ///< Nothing was written to it.
  nothing_to_do,  ///< It held all already.
  planned,        ///< With --dry-run.
  applied,
  not_kept,       ///< Every value is as wanted; keeping it failed.
  as_before,      ///< It failed, and every value is as it was before.
  flash_changed,  ///< Put back, whatever failed, but for what went to the flash of a drive that worked in
                  ///< RAM.
  undone,         ///< It was applied and put back, because another axis failed.
  failed          ///< Some values are neither, or are not known.
};
std::string_view text_of(AxisEnd end);
AxisEnd end_of(settings::RestoreEnd end);

/// One axis on its way.
struct AxisRun {
  AxisRun(const Station& at, const PlannedAxis* seen) : station(at), look(seen) {}
  Station station;
  const PlannedAxis* look;
  AxisEnd end = AxisEnd::untouched;
  report::Value frames;  ///< With --dry-run.
  std::vector<Error> errors;
  std::vector<Message> notices;
  std::vector<ObjectAddress> in_flash;  ///< As in session::RestoreOutcome.

  /// Whether every value is as wanted.
  bool is_written() const { return end == AxisEnd::applied || end == AxisEnd::not_kept; }
  /// It did not come to be as wanted.
  bool has_failed() const;
  /// Nothing can be written to it; what is left as it is (AxisPlan::left) is its errors.
  void end_without_write();
  /// It was to be put back, because another axis failed.
  void end_undo(const Result<settings::Restored>& done);
};

/// What was written to the axis, and of which no manual tells whether it is kept.
std::vector<std::string> unstated(const AxisRun& run);

/// The answer of an apply, a row an axis. `keep`: the values were to be kept.
report::Value apply_table(const std::vector<AxisRun>& runs, bool keep);

}  // namespace servoctl::cabinet
