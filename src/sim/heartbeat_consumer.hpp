#pragma once

#include <array>
#include <cstdint>

#include "base/time.hpp"
#include "can/frame.hpp"

namespace servoctl::sim {

/// The heartbeat consumer of a drive (1016h; CiA 301, 7.5.2.19): each entry watches one producer, from the
/// first heartbeat on that is received after the entry was written.
class HeartbeatConsumer {
 public:
  static constexpr std::size_t kMost = 8;

  /// `entry` 1..8 was written: bits 23-16 node-ID, bits 15-0 time in ms; either zero switches it off.
  void set(std::uint8_t entry, std::uint32_t value);
  void on_frame(const can::Frame& frame, TimePoint now);
  /// True once when a producer has become silent.
  bool take_lost(TimePoint now);
  TimePoint deadline() const;

 private:
  struct Entry {
    std::uint8_t node = 0;
    Duration time{};
    TimePoint ends = kNever;
  };
  std::array<Entry, kMost> entries_{};
};

}  // namespace servoctl::sim
