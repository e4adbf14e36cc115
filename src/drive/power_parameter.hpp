#pragma once

#include <cstdint>
#include <string>

namespace servoctl::drive {

/// A parameter that energises a motor, or sets it in motion, without the controlword: by any value but 0.
/// What ends that is `end`, with this value.
struct PowerParameter {
  std::string name;
  std::string end;
  std::int64_t value = 0;
};

}  // namespace servoctl::drive
