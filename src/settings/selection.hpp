#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "show/desk.hpp"

namespace servoctl::settings {

/// Whether an object belongs to a part of a drive's settings; empty: all do.
using Selection = std::function<bool(ObjectAddress)>;

/// `communication` (below 2000h), `pdo` (drive::is_of_pdos()), both with the parameters in which the drive
/// stores them, `params` or a group of the family's parameter table. Errc::usage for another word, with
/// these and `further` ones that the caller knows. The profile must outlive the selection.
Result<Selection> selection_of(const drive::Profile& profile, std::string_view word,
                               std::vector<std::string> further = {});

}  // namespace servoctl::settings
