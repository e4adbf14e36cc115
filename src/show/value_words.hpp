#pragma once

#include <cstdint>
#include <string>

#include "base/object_address.hpp"

namespace servoctl::show {

/// What a value means, in both languages; both are empty where nothing is known.
struct ValueWords {
  std::string english;
  std::string chinese;
};

/// The state and the bits of a statusword or controlword of any axis (CiA 402-2), the bits of the error
/// register (1001h, CiA 301) and of the supported drive modes (6502h). Bits that depend on the mode of
/// operation are told by their numbers.
ValueWords value_words(ObjectAddress object, std::uint64_t value);

}  // namespace servoctl::show
