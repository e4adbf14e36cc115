#pragma once

#include <cstdint>

#include "base/time.hpp"
#include "ethercat/registers.hpp"
#include "sim/esc_memory.hpp"

namespace servoctl::sim {

/// The distributed clock of a slave (0900h to 09FFh), as far as a master sets it up and a drive asks whether
/// SYNC0 comes: it keeps the time of the ring exactly, and makes no pulses. Its registers have 64 bits, or
/// 32: then time begins anew every 4.29 s (ETG.1000.4, 0008h bit 3).
class EscClock {
 public:
  /// What stands in the registers before the master reads them.
  void show(EscMemory& memory, TimePoint now) const {
    memory.set(ethercat::reg::kDcSystemTime, system_time(memory, now), 8);
  }
  /// The master has written 0900h: when the frame came is noted, at both ports.
  void latch(EscMemory& memory, TimePoint now) const {
    const auto time = local_time(now);
    for (std::uint16_t port = 0; port < 2; ++port)
      memory.set(static_cast<std::uint16_t>(ethercat::reg::kDcReceiveTimes + 4 * port), time, 4);
    memory.set(ethercat::reg::kDcUnitReceiveTime, bits_ == kWide ? time : static_cast<std::uint32_t>(time),
               8);
  }
  /// The master has written 0981h: pulses come when the time of the first is still to come.
  void activate(const EscMemory& memory, TimePoint now) {
    const auto ahead = memory.number(ethercat::reg::kDcStart, bits_ / 8) - system_time(memory, now);
    in_time_ = bits_ == kWide ? static_cast<std::int64_t>(ahead) > 0
                              : static_cast<std::int32_t>(static_cast<std::uint32_t>(ahead)) > 0;
  }
  void set_bits(unsigned bits) { bits_ = bits; }
  unsigned bits() const { return bits_; }
  void reset() { in_time_ = false; }

  /// SYNC0 is set up: cyclic, with a cycle.
  static bool is_set_up(const EscMemory& memory) {
    constexpr unsigned kCyclicSync0 = 3;
    return (memory[ethercat::reg::kDcActivation] & kCyclicSync0) == kCyclicSync0 &&
           memory.dword(ethercat::reg::kDcSync0Cycle) != 0;
  }
  /// … and comes.
  bool is_running(const EscMemory& memory) const { return is_set_up(memory) && in_time_; }

 private:
  /// ns on the clock of the ring; the clock of a drive knows no date.
  static std::uint64_t local_time(TimePoint now) {
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch()).count());
  }
  std::uint64_t system_time(const EscMemory& memory, TimePoint now) const {
    const auto time = local_time(now) + memory.number(ethercat::reg::kDcOffset, 8);
    return bits_ == kWide ? time : static_cast<std::uint32_t>(time);
  }

  static constexpr unsigned kWide = 64;

  unsigned bits_ = kWide;
  bool in_time_ = false;
};

}  // namespace servoctl::sim
