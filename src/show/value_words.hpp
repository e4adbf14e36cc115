#pragma once

#include <cstdint>
#include <string>

#include "base/object_address.hpp"

namespace servoctl::show {

/// What a value means: the state and the bits of a statusword or controlword of any axis (CiA 402-2), the
/// bits of the error register (1001h, CiA 301) and of the supported drive modes (6502h). Bits that depend on
/// the mode of operation are told by their numbers. Empty where nothing is known.
std::string value_words(ObjectAddress object, std::uint64_t value, bool chinese);

/// The same without bits: of a statusword the state, of a controlword the command.
std::string value_head(ObjectAddress object, std::uint64_t value, bool chinese);

}  // namespace servoctl::show
