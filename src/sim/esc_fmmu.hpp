#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim/esc_memory.hpp"

namespace servoctl::sim {

/// A fieldbus memory management unit (ETG.1000.4, clause 6.6): which bits of the logical address space of the
/// ring stand where in the memory of this slave. As its registers say now.
struct EscFmmu {
  /// Bits of a datagram that this slave has.
  struct Overlap {
    std::size_t data_bit = 0;      ///< Where they begin in the data of the datagram,
    std::uint64_t memory_bit = 0;  ///< and in the memory.
    std::size_t count = 0;
  };

  static EscFmmu load(const EscMemory& memory, unsigned number);
  /// Empty when it has none of these bytes.
  std::optional<Overlap> overlap(std::uint32_t logical, std::size_t size) const;

  std::uint64_t first_bit = 0;  ///< Logical.
  std::uint64_t bits = 0;
  std::uint64_t memory_bit = 0;
  bool reads = false;
  bool writes = false;
  bool active = false;
};

}  // namespace servoctl::sim
