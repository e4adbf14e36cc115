#include "base/decade.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <string>
#include <system_error>

namespace servoctl {

double power_of_ten(int exponent) {
  const auto text = "1e" + std::to_string(exponent);
  double out = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), out).ec == std::errc::result_out_of_range)
    return exponent > 0 ? std::numeric_limits<double>::infinity() : 0;
  return out;
}

int decade_of(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific).ptr;
  const auto* exponent = std::find(text.data(), end, 'e') + 1;
  int out = 0;
  std::from_chars(*exponent == '+' ? exponent + 1 : exponent, end, out);
  return out;
}

}  // namespace servoctl
