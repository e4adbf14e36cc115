#pragma once

#include <cstdint>
#include <optional>

#include "base/time.hpp"
#include "can/frame.hpp"
#include "canopen/cob_id.hpp"

namespace servoctl::canopen {

/// A SYNC message (CiA 301, 7.2.5), with its counter where there is one.
can::Frame sync_frame(std::optional<std::uint8_t> counter = {}, std::uint32_t can_id = kSync);

/// Produces SYNC in a steady period. A frame that is more than a period late is not made up for, but counted
/// as missed. Performs no I/O and reads no clock.
class SyncProducer {
 public:
  struct Options {
    Duration period{};
    std::uint8_t last_counter = 0;  ///< 1019h, 2..240: the counter runs from 1 to this; 0: without counter.
    std::uint32_t can_id = kSync;
  };
  /// The first SYNC is due at `start`.
  SyncProducer(Options options, TimePoint start) : options_(options), next_(start) {}

  void on_time(TimePoint now);
  std::optional<can::Frame> take_frame();
  TimePoint deadline() const { return next_; }
  std::uint64_t missed() const { return missed_; }

 private:
  Options options_;
  TimePoint next_;
  std::uint8_t counter_ = 0;
  std::uint64_t missed_ = 0;
  std::optional<can::Frame> tx_;
};

}  // namespace servoctl::canopen
