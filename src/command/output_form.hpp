#pragma once

#include <algorithm>
#include <string_view>

namespace servoctl::command {

/// What --output says of the form of a result.
inline constexpr std::string_view kOutputForms[] = {"text", "json", "jsonl"};

/// Whether the value of --output is one; where a command writes a file it may be the name of that.
inline bool is_output_form(std::string_view value) {
  return std::find(std::begin(kOutputForms), std::end(kOutputForms), value) != std::end(kOutputForms);
}

}  // namespace servoctl::command
