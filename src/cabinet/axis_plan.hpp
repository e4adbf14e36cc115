#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "cabinet/axis_needs.hpp"
#include "cabinet/cabinet.hpp"
#include "pdo/pdo_neighbours.hpp"
#include "settings/backup_file.hpp"
#include "settings/restore_target.hpp"
#include "show/desk.hpp"

namespace servoctl::cabinet {

/// What of the file is looked at, and how.
struct PlanChoice {
  std::string only = {};  ///< As selection_of(); empty: everything.
  bool unlisted = true;   ///< Reads all settings, for what is not in the file.
  bool keep = true;       ///< What is kept beside the values themselves is part of it.
  std::span<const drive::Family> families = {};
};

/// What differs between the file and one drive.
struct AxisPlan {
  session::Identity identity;
  settings::Backup wanted;       ///< Everything the file says of it, changed or not.
  session::Values present;       ///< What the drive held of that.
  std::filesystem::path before;  ///< Where what it holds is noted before the first write.
  std::size_t different = 0;     ///< Values that the drive holds otherwise.
  std::size_t to_write = 0;      ///< Those of them that are not left as they are.
  std::vector<Error> left;       ///< As settings::RestoreTarget::left().
  std::size_t compared = 0;
  report::Value differences;  ///< A table: what each is, what the drive holds, what the file says.
  report::Value unlisted;     ///< A table: what is not in the file, nor as the factory left it; null: none.
  std::size_t unlisted_count = 0;
  std::vector<AxisNeed> needs;
  std::vector<std::string> owed;          ///< Parameters that hold what was written and wait for a restart.
  std::vector<canopen::Pdo> pdos_before;  ///< Those that change, and what they become.
  std::vector<canopen::Pdo> pdos_after;
};

/// Holds the drive of an axis against the file, and reads what differs; writes nothing. `desk` has the
/// session and the family of the axis; it may be energised. Errc::refused for another drive and for what a
/// restore refuses, Errc::file and Errc::usage for what the file says and the drive does not have.
Result<AxisPlan> plan_axis(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                           const PlanChoice& choice);

/// The plan for values that are known already: those that a change that was cut off was to write.
Result<AxisPlan> plan_axis(show::Desk& desk, const Cabinet& cabinet, const Axis& axis,
                           settings::Backup wanted, const PlanChoice& choice);

}  // namespace servoctl::cabinet
