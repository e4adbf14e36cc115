#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace servoctl::drive {

/// What a literal of the program is in Chinese.
using Chinese = std::string_view (*)(std::string_view);

/// A statusword in words: its state, and in brackets what else is set, `operation enabled (remote, target
/// reached)`. `mode` as of statusword_bits(). `chinese` null: in English.
std::string statusword_words(std::uint16_t statusword, std::int8_t mode, Chinese chinese = nullptr);

/// A controlword in words: its command, and in brackets what else is set (CiA 402-2, 8.4.1 and the
/// controlword of each mode), `enable operation (new set-point, relative)`. `mode`: of CiA 402-2, 0 when it
/// is not known; then a bit that depends on it is told by its number.
std::string controlword_words(std::uint16_t controlword, std::int8_t mode, Chinese chinese = nullptr);

}  // namespace servoctl::drive
