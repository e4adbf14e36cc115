#include "canopen/sdo_habits.hpp"

#include <array>
#include <cstddef>

#include "canopen/sdo_frame.hpp"

namespace servoctl::canopen {
namespace {

constexpr std::uint8_t kWholeSize = 8;
constexpr std::uint8_t kLastOfBlock = 0x80;

/// Bytes that the command of a first answer, or of one to a segment, needs (CiA 301, 7.2.4.3).
std::size_t bytes_needed(std::uint8_t command) {
  const std::size_t unused = command >> 2U & 0x03U;
  switch (command & 0xE0U) {
    case 0x00: return 8U - (command >> 1U & 0x07U);
    case 0x20: return 1;
    case 0x40:
      if ((command & 0x02U) != 0) return (command & 0x01U) != 0 ? 8U - unused : 5U;
      return (command & 0x01U) != 0 ? 8U : 4U;
    case 0x60: return 4;
    case 0xA0: return (command & 0x03U) == 0 ? 5U : (command & 0x03U) == 1 ? 1U : 3U;
    case 0xC0: return (command & 0x01U) != 0 ? 3U : (command & 0x02U) != 0 ? 8U : 4U;
    default: return kWholeSize;
  }
}

}  // namespace

std::string_view text(SdoHabit habit) {
  constexpr std::array<std::string_view, kSdoHabits> kTexts{
      "its SDO answers have fewer than 8 bytes; those with all that their command needs are taken",
      "it announced more bytes for an object than it sent; what came was taken",
      "its SDO aborts name no object; they are taken for the request that was open",
      "it answers with 4 bytes for objects that have fewer; the zeros above are left out"};
  return kTexts.at(static_cast<std::size_t>(habit));
}

std::optional<can::Frame> whole_sdo_answer(const can::Frame& frame, bool in_block) {
  if (frame.size == kWholeSize) return frame;
  if (frame.size == 0 || frame.size > kWholeSize) return std::nullopt;
  const auto command = frame.data[0];
  const bool is_segment = in_block && command != kSdoAbortCommand;
  // Only the last segment of a block may hold less; its end says how much.
  if (is_segment && (frame.size < 2 || (command & kLastOfBlock) == 0)) return std::nullopt;
  if (!is_segment && frame.size < bytes_needed(command)) return std::nullopt;
  auto out = frame;
  for (std::size_t i = frame.size; i < kWholeSize; ++i) out.data[i] = 0;
  out.size = kWholeSize;
  const bool size_unknown = !is_segment && (command & 0xE3U) == 0x42;
  if (size_unknown) out.data[0] = static_cast<std::uint8_t>(0x43U | (8U - frame.size) << 2U);
  return out;
}

}  // namespace servoctl::canopen
