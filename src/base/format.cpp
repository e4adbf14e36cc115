#include "base/format.hpp"

#include <fmt/format.h>

namespace servoctl {

std::string formatted_of(fmt::string_view text, fmt::format_args values) {
  return fmt::vformat(text, values);
}

}  // namespace servoctl
