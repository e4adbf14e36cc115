#pragma once

#include <string_view>

namespace servoctl::od {

/// The comment (CiA 306-1, [Comments]) of an EDS that was made by reading a drive index by index: nobody said
/// which of the maker's objects can be written.
inline constexpr std::string_view kLearnedMark =
    "servoctl-learned: access, sign and limits of other than standard objects are not known";

/// Whether this EDS has the mark.
bool is_learned(std::string_view eds);

}  // namespace servoctl::od
