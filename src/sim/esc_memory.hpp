#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/bytes.hpp"

namespace servoctl::sim {

/// The address space of an EtherCAT slave controller, as bytes: registers below 1000h, memory behind them.
/// What an access means is the controller's.
class EscMemory {
 public:
  static constexpr std::size_t kSize = 0x10000;

  EscMemory() : bytes_(kSize) {}

  void clear() { bytes_.assign(kSize, 0); }
  std::uint8_t& operator[](std::uint16_t address) { return bytes_[address]; }
  std::uint8_t operator[](std::uint16_t address) const { return bytes_[address]; }

  std::uint16_t word(std::uint16_t address) const { return static_cast<std::uint16_t>(number(address, 2)); }
  std::uint32_t dword(std::uint16_t address) const { return static_cast<std::uint32_t>(number(address, 4)); }
  std::uint64_t number(std::uint16_t address, std::size_t size) const {
    return load_le(ByteSpan(bytes_).subspan(address, size));
  }
  void set(std::uint16_t address, std::uint64_t value, std::size_t size) {
    store_le(value, std::span(bytes_).subspan(address, size));
  }
  std::span<std::uint8_t> area(std::uint16_t address, std::size_t size) {
    return std::span(bytes_).subspan(address, size);
  }

 private:
  Bytes bytes_;
};

}  // namespace servoctl::sim
