#pragma once

#include <gtest/gtest.h>

#include <string_view>

#include "base/bytes.hpp"

namespace servoctl::ethercat {

/// `64 00` as bytes; a digit that is none fails the test.
inline Bytes hex(std::string_view text) {
  const auto parsed = parse_hex_bytes(text);
  EXPECT_TRUE(parsed) << text;
  return parsed.value_or(Bytes{});
}

}  // namespace servoctl::ethercat
