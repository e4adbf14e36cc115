#include "show/value_words.hpp"

#include <string_view>

#include "base/text.hpp"
#include "canopen/emergency.hpp"
#include "drive/cia402.hpp"
#include "drive/standard_objects.hpp"
#include "drive/word_bits.hpp"
#include "report/catalogue.hpp"
#include "report/told.hpp"

namespace servoctl::show {
namespace {

std::string register_words(std::uint64_t value, drive::Chinese chinese) {
  constexpr unsigned kBits = 8;
  std::string out;
  for (unsigned bit = 0; bit < kBits; ++bit) {
    if ((value >> bit & 1U) == 0) continue;
    const auto word = canopen::error_register_text(static_cast<std::uint8_t>(1U << bit));
    append(out, chinese != nullptr ? std::string(chinese(word)) : word, chinese != nullptr ? "，" : ", ");
  }
  if (out.empty()) return std::string(chinese != nullptr ? chinese("no error") : "no error");
  return out;
}

/// Which bit is which switch, and its active level, differ from family to family.
std::string input_words(std::uint64_t inputs, const drive::Profile* family, drive::Chinese chinese) {
  if (family == nullptr) return {};
  const auto words = drive::switch_words(family->rules.motion, static_cast<std::uint32_t>(inputs), chinese);
  const bool assumed = family->rules.is_assumed("motion.inputs_active_low");
  return assumed ? report::told(chinese != nullptr, "{} (active level assumed)", words) : words;
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

std::string value_words(ObjectAddress object, std::uint64_t value, bool chinese, const drive::Profile* family,
                        std::int8_t mode) {
  const drive::Chinese in_chinese = chinese ? report::chinese_word : nullptr;
  const auto word = static_cast<std::uint16_t>(value);
  const auto first = drive::of_first_axis(object);
  if (first == objects::kStatusword) return drive::statusword_words(word, mode, in_chinese);
  if (first == objects::kControlword) return drive::controlword_words(word, mode, in_chinese);
  if (first == objects::kDigitalInputs) return input_words(value, family, in_chinese);
  if (first == objects::kSupportedModes) return mode_words(value);
  return object == objects::kErrorRegister ? register_words(value, in_chinese) : std::string();
}

std::string value_head(ObjectAddress object, std::uint64_t value, bool chinese,
                       const drive::Profile* family) {
  // Bits that make the state or the command, and no others.
  constexpr std::uint64_t kStateBits = 0x006F;
  constexpr std::uint64_t kCommandBits = 0x008F;
  const auto first = drive::of_first_axis(object);
  if (first == objects::kStatusword) {
    const auto state = drive::decode_state(static_cast<std::uint16_t>(value & kStateBits));
    return std::string(chinese ? drive::name_zh(state) : drive::name(state));
  }
  const bool command = first == objects::kControlword;
  return value_words(object, command ? value & kCommandBits : value, chinese, family);
}

}  // namespace servoctl::show
