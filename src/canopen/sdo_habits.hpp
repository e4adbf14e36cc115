#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "can/frame.hpp"

namespace servoctl::canopen {

/// What some SDO servers do that CiA 301 does not allow, and that leaves no doubt about what they mean.
enum class SdoHabit : std::uint8_t {
  short_answer,          ///< Answers of fewer than 8 bytes, with all that their command needs.
  announced_more,        ///< A read announces more bytes than come.
  abort_without_object,  ///< An abort with index and sub-index 0.
  always_four_bytes,     ///< 43h for an object that has fewer: those above are 0.
};
inline constexpr std::size_t kSdoHabits = 4;

/// A half sentence: `its SDO answers have fewer than 8 bytes`.
std::string_view text(SdoHabit habit);

/// The answer of a server with 8 bytes. One that is shorter is filled up with zeros where it has all that its
/// command needs; empty where it has not. An expedited answer without a size has as many bytes of data as
/// came. `in_block`: a block is being read, and byte 0 is the number of a segment.
std::optional<can::Frame> whole_sdo_answer(const can::Frame& frame, bool in_block);

}  // namespace servoctl::canopen
