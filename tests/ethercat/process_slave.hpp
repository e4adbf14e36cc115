#pragma once

#include <algorithm>
#include <array>

#include "ethercat/frame.hpp"

namespace servoctl::ethercat {

/// The memory of a slave with its FMMUs and sync managers, written from ETG.1000.4, 6.6 and 6.7, without a
/// line of the master's plan: whole bytes, one FMMU a direction.
class ProcessSlave {
 public:
  explicit ProcessSlave(std::uint16_t station) : station_(station) {}

  std::array<std::uint8_t, 0x10000> memory{};
  bool gone = false;
  bool takes = true;  ///< Outputs.
  bool gives = true;  ///< Inputs.

  /// One datagram passes. What it adds to the working counter.
  unsigned pass(const Datagram& datagram, std::span<std::uint8_t> data) {
    if (gone) return 0;
    switch (static_cast<int>(datagram.command)) {
      case 4: return datagram.adp() == station_ ? copy(&memory[datagram.ado()], data.data(), data.size()) : 0;
      case 5: return datagram.adp() == station_ ? copy(data.data(), &memory[datagram.ado()], data.size()) : 0;
      case 10: return read(datagram.address, data);
      case 11: return write(datagram.address, data);
      case 12: return write(datagram.address, data) * 2 + read(datagram.address, data);
      default: return 0;
    }
  }

 private:
  struct Window {
    std::size_t skip = 0;  ///< Bytes of the datagram in front.
    std::size_t from = 0;
    std::size_t size = 0;
  };
  static unsigned copy(const std::uint8_t* from, std::uint8_t* to, std::size_t size) {
    std::copy_n(from, size, to);
    return 1;
  }
  unsigned word(std::size_t at) const { return static_cast<unsigned>(memory[at] | memory[at + 1] << 8); }
  /// The part of a logical range that the FMMU of this type maps, if a sync manager stands behind it.
  Window window(unsigned type, std::uint32_t address, std::size_t size) const {
    for (std::size_t at = 0x0600; at < 0x0640; at += 16) {
      if (memory[at + 12] != 1 || memory[at + 11] != type || memory[at + 6] != 0 || memory[at + 7] != 7)
        continue;
      const std::uint32_t logical = word(at) | word(at + 2) << 16;
      const std::size_t length = word(at + 4);
      const std::size_t physical = word(at + 8);
      if (!buffered(physical, length)) continue;
      const auto begin = std::max<std::size_t>(address, logical);
      const auto end = std::min<std::size_t>(address + size, logical + length);
      if (begin < end) return {begin - address, physical + begin - logical, end - begin};
    }
    return {};
  }
  bool buffered(std::size_t start, std::size_t length) const {
    for (std::size_t at = 0x0800; at < 0x0840; at += 8)
      if (word(at) == start && word(at + 2) == length && memory[at + 6] == 1) return true;
    return false;
  }
  unsigned write(std::uint32_t address, std::span<const std::uint8_t> data) {
    const auto w = window(2, address, data.size());
    if (w.size == 0 || !takes) return 0;
    return copy(data.data() + w.skip, &memory[w.from], w.size);
  }
  unsigned read(std::uint32_t address, std::span<std::uint8_t> data) {
    const auto w = window(1, address, data.size());
    if (w.size == 0 || !gives) return 0;
    return copy(&memory[w.from], data.data() + w.skip, w.size);
  }

  std::uint16_t station_;
};

}  // namespace servoctl::ethercat
