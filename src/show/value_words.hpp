#pragma once

#include <cstdint>
#include <string>

#include "base/object_address.hpp"
#include "drive/profile.hpp"

namespace servoctl::show {

/// What a value means: the state and the bits of a statusword or controlword (CiA 402-2), the switches of the
/// digital inputs (60FDh) and the supported drive modes (6502h), of any axis; the bits of the error register
/// (1001h, CiA 301). `family`: null where it is not known; then nothing is said of the digital inputs.
/// `mode`: as of drive::controlword_words(). Empty where nothing is known.
std::string value_words(ObjectAddress object, std::uint64_t value, bool chinese, const drive::Profile* family,
                        std::int8_t mode = 0);

/// The same without bits: of a statusword the state, of a controlword the command.
std::string value_head(ObjectAddress object, std::uint64_t value, bool chinese, const drive::Profile* family);

}  // namespace servoctl::show
