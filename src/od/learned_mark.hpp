#pragma once

#include <string_view>

namespace servoctl::od {

/// The comment (CiA 306-1, [Comments]) of an EDS that was made by reading a drive index by index: nobody said
/// which of the objects that no standard knows can be written. read_eds() looks for its first word.
inline constexpr std::string_view kLearnedMark =
    "servoctl-learned: access, sign and limits of other than standard objects are not known";
inline constexpr std::string_view kLearnedWord = kLearnedMark.substr(0, kLearnedMark.find(':'));

}  // namespace servoctl::od
