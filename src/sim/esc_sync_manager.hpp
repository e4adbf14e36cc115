#pragma once

#include <cstdint>
#include <span>

#include "base/bytes.hpp"

namespace servoctl::sim {

/// One sync manager of an EtherCAT slave controller (ETG.1000.4, clause 6.7): it watches over an area of the
/// memory, so that master and processor never see half a message. With one buffer (mailbox) it is written,
/// and read before it is written again; with three (process data) each side has the newest whole image.
/// An access begins with the first byte of the area and takes effect with its last.
class EscSyncManager {
 public:
  /// Registers, by their place behind 0800h + 8 × number.
  std::uint8_t register_at(unsigned offset) const;
  /// By the master; false for a byte that cannot be written. Start, length and control stay as they are
  /// while the sync manager is enabled.
  bool write_register(unsigned offset, std::uint8_t value);
  void reset();

  std::uint16_t start() const { return start_; }
  std::uint16_t length() const { return length_; }
  std::uint8_t control() const { return control_; }
  bool is_enabled() const { return enabled_; }
  bool is_mailbox() const { return (control_ & 3U) == 2U; }
  bool is_buffered() const { return (control_ & 3U) == 0U; }
  bool master_writes() const { return (control_ >> 2U & 3U) == 1U; }
  bool has_watchdog() const { return (control_ & 0x40U) != 0; }
  bool covers(std::uint32_t address) const {
    return enabled_ && address >= start_ && address < std::uint32_t{start_} + length_;
  }

  /// Accesses of the master within the area, at `offset` from its start; false when it is refused, and then
  /// nothing was done.
  bool read(std::uint32_t offset, std::span<std::uint8_t> out);
  bool write(std::uint32_t offset, ByteSpan data);
  /// What a bit that the master does not write keeps.
  std::uint8_t peek(std::uint32_t offset) const { return filling_[offset]; }

  // What the processor does.
  bool is_full() const { return full_; }
  /// What the master wrote last; a mailbox is empty afterwards.
  const Bytes& take();
  /// What the master reads next; as long as the area, the rest zero.
  void put(ByteSpan data);
  /// Takes back a message that was not read.
  Bytes recall();
  /// Whether the master has written, or read, the whole area since the last question.
  bool take_written();
  bool take_read();
  /// Of a mailbox that the master reads: it wants the last message again (0806h bit 1).
  bool wants_repeat() const { return repeat_ != repeated_; }
  void confirm_repeat() { repeated_ = repeat_; }

 private:
  void clear();

  std::uint16_t start_ = 0;
  std::uint16_t length_ = 0;
  std::uint8_t control_ = 0;
  bool enabled_ = false;
  bool repeat_ = false;
  bool repeated_ = false;
  bool full_ = false;   ///< The mailbox holds a message.
  bool open_ = false;   ///< The first byte was accessed and the last was not.
  bool begun_ = false;  ///< With three buffers: an image was written whole.
  bool written_ = false;
  bool read_ = false;
  Bytes filling_;  ///< What is being written.
  Bytes whole_;    ///< The last that was written whole.
  Bytes reading_;  ///< What the master reads: whole_ as it was when it began.
};

}  // namespace servoctl::sim
