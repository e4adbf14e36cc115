#pragma once

#include <string>
#include <string_view>

#include "base/format.hpp"
#include "report/catalogue.hpp"

namespace servoctl::report {

/// formatted(english, …) in the language of who reads. It costs little more than that, so that each of many
/// frames may be told; the format has to stand in the catalogue as it is here, with placeholders `{}` alone.
template <typename... T>
std::string told(bool chinese, std::string_view english, const T&... values) {
  const auto format = chinese ? chinese_word(english) : english;
  return formatted_of(fmt::string_view(format.data(), format.size()), fmt::make_format_args(values...));
}

}  // namespace servoctl::report
