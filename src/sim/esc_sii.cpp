#include "sim/esc_sii.hpp"

#include <algorithm>

#include "ethercat/registers.hpp"

namespace servoctl::sim {
namespace reg = ethercat::reg;

namespace {

constexpr std::size_t kAreaSize = 14;  ///< Bytes under the checksum, which is the next one.
constexpr std::size_t kAliasAt = 8;
constexpr std::uint16_t kReload = 0x0400;
constexpr std::uint16_t kCommands = 0x0700;

}  // namespace

std::uint8_t sii_crc(ByteSpan area) {
  std::uint8_t crc = 0xFF;
  for (const auto byte : area) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint8_t>((crc & 0x80U) != 0 ? unsigned{crc} << 1U ^ 0x07U : unsigned{crc} << 1U);
  }
  return crc;
}

bool EscSii::is_sound() const {
  return content_.size() > kAreaSize && sii_crc(ByteSpan(content_).first(kAreaSize)) == content_[kAreaSize];
}

void EscSii::power_on(EscMemory& registers) {
  ends_ = kNever;
  command_ = 0;
  errors_ = mute ? reg::kSiiNotLoaded : is_sound() ? std::uint16_t{0} : reg::kSiiChecksumError;
  const auto alias = errors_ == 0 ? load_le(ByteSpan(content_).subspan(kAliasAt, 2)) : 0;
  registers.set(reg::kStationAlias, alias, 2);
  set_status(registers, errors_);
}

void EscSii::set_status(EscMemory& registers, std::uint16_t bits) const {
  registers.set(reg::kSiiControl, bits | (eight_bytes ? reg::kSiiEightBytes : 0U), 2);
}

bool EscSii::is_writable(const EscMemory& registers, std::uint16_t address) const {
  if (address <= reg::kSiiAccess + 1) return address == reg::kSiiAccess;
  const bool of_processor = (registers[reg::kSiiAccess] & reg::kSiiToProcessor) != 0;
  return !of_processor && ends_ == kNever;
}

void EscSii::on_command(EscMemory& registers, TimePoint now) {
  const auto control = registers.word(reg::kSiiControl);
  command_ = control & (kCommands | reg::kSiiWrite);
  if ((control & kCommands) == 0) {  // Acknowledges the errors of the last one.
    errors_ = 0;
    return set_status(registers, 0);
  }
  ends_ = now + delay;
  set_status(registers, static_cast<std::uint16_t>(reg::kSiiBusy | (command_ & kCommands)));
  on_time(registers, now);
}

void EscSii::on_time(EscMemory& registers, TimePoint now) {
  if (now < ends_) return;
  ends_ = kNever;
  carry_out(registers);
  set_status(registers, errors_);
}

void EscSii::carry_out(EscMemory& registers) {
  constexpr std::uint16_t kWriteCommand = 0x0200;
  const auto command = command_ & kCommands;
  const auto at = std::size_t{registers.dword(reg::kSiiAddress)} * 2;
  errors_ = mute ? reg::kSiiCommandError : std::uint16_t{0};
  if (mute) return;
  if (command == reg::kSiiRead) {
    auto out = registers.area(reg::kSiiData, eight_bytes ? 8 : 4);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = at + i < content_.size() ? content_[at + i] : std::uint8_t{0xFF};
  } else if (command == kWriteCommand) {
    if ((command_ & reg::kSiiWrite) == 0) {
      errors_ = reg::kSiiWriteError;
    } else if (at + 2 > content_.size()) {
      errors_ = reg::kSiiCommandError;
    } else {
      const auto data = registers.area(reg::kSiiData, 2);
      std::copy(data.begin(), data.end(), content_.begin() + static_cast<std::ptrdiff_t>(at));
    }
  } else if (command == kReload) {
    power_on(registers);
  } else {
    errors_ = reg::kSiiCommandError;
  }
}

}  // namespace servoctl::sim
