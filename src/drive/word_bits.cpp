#include "drive/word_bits.hpp"

#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "base/text.hpp"
#include "drive/cia402.hpp"

namespace servoctl::drive {
namespace {

constexpr unsigned kFirstModeBit = 4;
constexpr unsigned kFaultReset = 7;
constexpr unsigned kHalt = 8;

std::string_view command_name(ControlCommand command) {
  switch (command) {
    case ControlCommand::shutdown: return "shutdown";
    case ControlCommand::switch_on: return "switch on";
    case ControlCommand::enable_operation: return "enable operation";
    case ControlCommand::disable_voltage: return "disable voltage";
    case ControlCommand::quick_stop: return "quick stop";
    case ControlCommand::fault_reset: return "fault reset";
    case ControlCommand::none: break;
  }
  return "no command";
}

/// Bits 4 to 6 and 9 in the modes that give them a meaning; empty for the others.
std::string_view mode_word(unsigned bit, std::int8_t mode) {
  switch (mode * 16 + static_cast<int>(bit)) {
    case 1 * 16 + 4: return "new set-point";
    case 1 * 16 + 5: return "change set immediately";
    case 1 * 16 + 6: return "relative";
    case 1 * 16 + 9: return "change on set-point";
    case 2 * 16 + 4: return "enable ramp";
    case 2 * 16 + 5: return "unlock ramp";
    case 2 * 16 + 6: return "reference ramp";
    case 6 * 16 + 4: return "homing operation start";
    case 7 * 16 + 4: return "enable interpolation";
    default: return {};
  }
}

std::string in_language(std::string_view word, Chinese chinese) {
  return std::string(chinese != nullptr ? chinese(word) : word);
}

std::string bit_number(unsigned bit, Chinese chinese) {
  const auto format = in_language("bit {}", chinese);
  return formatted_of(format, fmt::make_format_args(bit));
}

void add_bit(std::string& bits, const std::string& bit, Chinese chinese) {
  append(bits, bit, chinese != nullptr ? "，" : ", ");
}

std::string in_brackets(const std::string& head, const std::string& rest, Chinese chinese) {
  if (rest.empty()) return head;
  return chinese != nullptr ? head + "（" + rest + "）" : formatted("{} ({})", head, rest);
}

}  // namespace

ObjectAddress of_first_axis(ObjectAddress object) {
  constexpr std::uint16_t kFirst = 0x6000;
  constexpr std::uint16_t kLast = 0x9FFF;
  constexpr std::uint16_t kStep = 0x0800;
  if (object.index < kFirst || object.index > kLast) return object;
  return {static_cast<std::uint16_t>(kFirst + (object.index - kFirst) % kStep), object.sub};
}

namespace {

/// `set bits: 2, 16-21`
std::string set_bits(std::uint32_t word, Chinese chinese) {
  if (word == 0) return in_language("no bit is set", chinese);
  std::string bits;
  for (unsigned bit = 0; bit < 32; ++bit) {
    if ((word >> bit & 1U) == 0) continue;
    unsigned last = bit;
    while (last < 31 && (word >> (last + 1) & 1U) != 0) ++last;
    append(bits, last == bit ? formatted("{}", bit) : formatted("{}-{}", bit, last), ", ");
    bit = last;
  }
  const auto format = in_language("set bits: {}", chinese);
  return formatted_of(format, fmt::make_format_args(bits));
}

}  // namespace

std::string switch_words(const MotionRules& rules, std::uint32_t inputs, Chinese chinese) {
  if (!rules.inputs_known) return set_bits(inputs, chinese);
  constexpr std::array<std::string_view, 3> kSwitches{"negative limit", "positive limit", "home switch"};
  std::string out;
  for (std::size_t i = 0; i < std::min(kSwitches.size(), rules.inputs.size()); ++i)
    if (rules.is_actuated(inputs, rules.inputs[i])) add_bit(out, in_language(kSwitches[i], chinese), chinese);
  return out.empty() ? in_language("no limit, no home switch", chinese) : out;
}

std::string statusword_words(std::uint16_t statusword, std::int8_t mode, Chinese chinese) {
  std::string bits;
  for (const auto& bit : statusword_bits(statusword, mode)) add_bit(bits, in_language(bit, chinese), chinese);
  const auto state = decode_state(statusword);
  return in_brackets(std::string(chinese != nullptr ? name_zh(state) : name(state)), bits, chinese);
}

std::string controlword_words(std::uint16_t controlword, std::int8_t mode, Chinese chinese) {
  std::string bits;
  for (unsigned bit = kFirstModeBit; bit < 16; ++bit) {
    if ((controlword & 1U << bit) == 0 || bit == kFaultReset) continue;
    const auto word = bit == kHalt ? std::string_view("halt") : mode_word(bit, mode);
    add_bit(bits, word.empty() ? bit_number(bit, chinese) : in_language(word, chinese), chinese);
  }
  return in_brackets(in_language(command_name(decode_command(controlword, 0)), chinese), bits, chinese);
}

}  // namespace servoctl::drive
