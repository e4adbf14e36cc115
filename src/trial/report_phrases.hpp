#pragma once

#include <string>
#include <string_view>

#include "report/value.hpp"

namespace servoctl::trial {

/// What a command says in English, in Chinese: words, and sentences around names and numbers. The text itself
/// where there is no Chinese for it.
std::string phrase_zh(std::string_view text);

/// The same of every text that a value shows to people, the names of plotted quantities too. What a drive
/// says of itself (its name, its versions) stays as it is.
report::Value in_chinese(report::Value value);

}  // namespace servoctl::trial
