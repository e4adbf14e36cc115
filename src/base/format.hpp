#pragma once

#include <fmt/core.h>
#include <string>

namespace servoctl {

/// As fmt::vformat(), compiled once for the whole program.
std::string formatted_of(fmt::string_view text, fmt::format_args values);

/// As fmt::format(), with the same checks at compile time.
template <typename... Values>
std::string formatted(fmt::format_string<Values...> text, Values&&... values) {
  return formatted_of(text, fmt::make_format_args(values...));
}

}  // namespace servoctl
