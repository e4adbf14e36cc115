#pragma once

#include <span>
#include <string_view>
#include <utility>

namespace servoctl::trial {

/// English, and what it is in Chinese.
using PhrasePair = std::pair<std::string_view, std::string_view>;

/// Texts that stand in reports as a whole, each once.
std::span<const PhrasePair> whole_phrases();

}  // namespace servoctl::trial
