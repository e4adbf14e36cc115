#pragma once

#include <cstdint>
#include <span>

#include "base/time.hpp"
#include "ethercat/frame.hpp"
#include "sim/esc_fmmu.hpp"
#include "sim/esc_registers.hpp"

namespace servoctl::sim {

/// The controller of an EtherCAT slave: a frame passes through it, and each datagram that is for this slave
/// reads and writes its registers on the way and counts it (ETG.1000.4, clauses 5.4 and 6). Reads no clock.
class EscController {
 public:
  EscRegisters& registers() { return registers_; }
  const EscRegisters& registers() const { return registers_; }

  /// Changes the frame in place. False for one whose lengths do not fit: it is counted, and goes no further.
  bool process(std::span<std::uint8_t> frame, TimePoint now);

 private:
  using Command = ethercat::Command;
  /// What a datagram does here.
  struct Access {
    bool reads = false;
    bool writes = false;
    bool merges = false;  ///< What is read is added to what others have said: a broadcast.
    unsigned write_weight = 1;
  };

  Access access_of(const ethercat::Datagram& datagram) const;
  unsigned access_memory(std::uint32_t address, Access access, std::span<std::uint8_t> data);
  unsigned access_logical(std::uint32_t address, Command command, std::span<std::uint8_t> data);
  bool read_bits(const EscFmmu::Overlap& bits, std::span<std::uint8_t> data);
  bool write_bits(const EscFmmu::Overlap& bits, ByteSpan data);

  EscRegisters registers_;
};

}  // namespace servoctl::sim
