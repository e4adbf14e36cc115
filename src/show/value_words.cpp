#include "show/value_words.hpp"

#include <string_view>

#include "base/text.hpp"
#include "canopen/emergency.hpp"
#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"
#include "drive/word_bits.hpp"
#include "report/catalogue.hpp"

namespace servoctl::show {
namespace {

constexpr std::uint16_t kFirstAxis = 0x6000;
constexpr std::uint16_t kLastAxis = 0x9FFF;
constexpr std::uint16_t kAxisStep =
    0x0800;  ///< From the objects of one axis to those of the next (CiA 402-2).

/// The object of the first axis that this one is on its own axis.
ObjectAddress of_first_axis(ObjectAddress object) {
  if (object.index < kFirstAxis || object.index > kLastAxis) return object;
  return {static_cast<std::uint16_t>(kFirstAxis + (object.index - kFirstAxis) % kAxisStep), object.sub};
}

std::string register_words(std::uint64_t value, drive::Chinese chinese) {
  constexpr unsigned kBits = 8;
  std::string out;
  for (unsigned bit = 0; bit < kBits; ++bit) {
    if ((value >> bit & 1U) == 0) continue;
    const auto word = canopen::error_register_text(static_cast<std::uint8_t>(1U << bit));
    append(out, chinese != nullptr ? std::string(chinese(word)) : word, chinese != nullptr ? "，" : ", ");
  }
  return out;
}

std::string mode_words(std::uint64_t modes) {
  constexpr std::int8_t kLastMode = 10;
  std::string out;
  for (std::int8_t mode = 1; mode <= kLastMode; ++mode)
    if ((modes >> (mode - 1) & 1U) != 0 && !drive::mode_abbreviation(mode).empty())
      append(out, std::string(drive::mode_abbreviation(mode)));
  return out;
}

}  // namespace

std::string value_words(ObjectAddress object, std::uint64_t value, bool chinese) {
  constexpr std::int8_t kUnknownMode = 0;
  const drive::Chinese in_chinese = chinese ? report::chinese_word : nullptr;
  const auto word = static_cast<std::uint16_t>(value);
  const auto first = of_first_axis(object);
  if (first == objects::kStatusword) return drive::statusword_words(word, kUnknownMode, in_chinese);
  if (first == objects::kControlword) return drive::controlword_words(word, kUnknownMode, in_chinese);
  if (first == objects::kSupportedModes) return mode_words(value);
  return object == objects::kErrorRegister ? register_words(value, in_chinese) : std::string();
}

std::string value_head(ObjectAddress object, std::uint64_t value, bool chinese) {
  // Bits that make the state or the command, and no others.
  constexpr std::uint64_t kStateBits = 0x006F;
  constexpr std::uint64_t kCommandBits = 0x008F;
  const auto first = of_first_axis(object);
  if (first == objects::kStatusword) {
    const auto state = drive::decode_state(static_cast<std::uint16_t>(value & kStateBits));
    return std::string(chinese ? drive::name_zh(state) : drive::name(state));
  }
  return value_words(object, first == objects::kControlword ? value & kCommandBits : value, chinese);
}

}  // namespace servoctl::show
