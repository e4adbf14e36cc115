#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/object_address.hpp"
#include "drive/rules.hpp"

namespace servoctl::drive {

/// The object of the first axis that this one is on its own axis (CiA 402-2: 0800h from axis to axis).
ObjectAddress of_first_axis(ObjectAddress object);

/// What a literal of the program is in Chinese.
using Chinese = std::string_view (*)(std::string_view);

/// A statusword in words: its state, and in brackets what else is set, `operation enabled (remote, target
/// reached)`. `mode` as of statusword_bits(). `chinese` null: in English.
std::string statusword_words(std::uint16_t statusword, std::int8_t mode, Chinese chinese = nullptr);

/// A controlword in words: its command, and in brackets what else is set (CiA 402-2, 8.4.1 and the
/// controlword of each mode), `enable operation (new set-point, relative)`. `mode`: of CiA 402-2, 0 when it
/// is not known; then a bit that depends on it is told by its number.
std::string controlword_words(std::uint16_t controlword, std::int8_t mode, Chinese chinese = nullptr);

/// Which switches are actuated by the digital inputs (60FDh), `negative limit, home switch`; `no limit, no
/// home switch` where none is. Where the family does not say which bit and level belong to a switch, which
/// bits are set: makers differ in both.
std::string switch_words(const MotionRules& rules, std::uint32_t inputs, Chinese chinese = nullptr);

}  // namespace servoctl::drive
