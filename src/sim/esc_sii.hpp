#pragma once

#include <cstdint>
#include <utility>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "sim/esc_memory.hpp"

namespace servoctl::sim {

/// The SII of a slave at work: the EEPROM behind registers 0500h to 050Fh (ETG.1000.4, clause 6.4). What it
/// holds outlives power-off. Reads no clock.
class EscSii {
 public:
  void set_content(Bytes content) { content_ = std::move(content); }
  const Bytes& content() const { return content_; }
  bool eight_bytes = true;  ///< A read brings eight bytes, else four.
  bool mute = false;        ///< The EEPROM does not answer.
  Duration delay{};         ///< From a command to its end; the interface is busy so long.

  /// Power comes: the configuration area is loaded; the alias (0012h) is 0 where its checksum is wrong.
  void power_on(EscMemory& registers);
  /// What the master may write now of these registers (0500h ff.), by their address.
  bool is_writable(const EscMemory& registers, std::uint16_t address) const;
  /// The master has written the control register (0502h): a command begins.
  void on_command(EscMemory& registers, TimePoint now);
  void on_time(EscMemory& registers, TimePoint now);
  TimePoint deadline() const { return ends_; }

 private:
  void carry_out(EscMemory& registers);
  bool is_sound() const;
  void set_status(EscMemory& registers, std::uint16_t bits) const;

  Bytes content_;
  std::uint16_t command_ = 0;
  std::uint16_t errors_ = 0;
  TimePoint ends_ = kNever;
};

/// The checksum of the configuration area: CRC-8 of words 0 to 6, polynomial 07h, begun with FFh
/// (ETG.1000.6, 5.4).
std::uint8_t sii_crc(ByteSpan area);

}  // namespace servoctl::sim
