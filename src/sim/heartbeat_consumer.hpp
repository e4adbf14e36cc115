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

  /// `entry` 1..8 was written, as canopen::watched_node() reads it.
  void set(std::uint8_t entry, std::uint32_t value);
  void on_frame(const can::Frame& frame, TimePoint now);
  /// True once when a producer has become silent.
  bool take_lost(TimePoint now);
  /// True once when a producer that had become silent is heard again, and none is silent any more.
  bool take_found();
  TimePoint deadline() const;

 private:
  struct Entry {
    std::uint8_t node = 0;
    Duration time{};
    TimePoint ends = kNever;
    bool lost = false;
  };
  std::array<Entry, kMost> entries_{};
  bool found_ = false;
};

}  // namespace servoctl::sim
