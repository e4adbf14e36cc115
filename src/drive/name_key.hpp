#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace servoctl::drive {

/// The form in which names are compared: that of od::identifier(), and letters of other scripts kept, without
/// the blanks beside them (`Pr1.01 速度环 增益` is `pr1_01速度环增益`).
std::string name_key(std::string_view name);

/// The words of a key, which a name has to contain to be meant in part.
std::vector<std::string> key_words(std::string_view text);

/// Whether the key of a name contains all of the words, none of them cut out of a longer number.
bool has_words(std::string_view key, const std::vector<std::string>& words);

}  // namespace servoctl::drive
