#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/time.hpp"
#include "ethercat/process_image.hpp"
#include "ethercat/request.hpp"
#include "ethercat/ring.hpp"

namespace servoctl::ethercat {

/// Whether a slave that refuses a state asks for synchronisation by its distributed clock: AL status codes of
/// ETG.1000.6, table 11, from "free run not supported" on.
bool demands_clock(std::uint16_t al_code);

/// SYNC0 of one slave: pulses that its own clock makes (ETG.1000.4, 6.5), and the cycles of a process image
/// kept half a period away from them, so that a late frame still comes in time. Other slaves have pulses of
/// their own: nothing is distributed. Performs no I/O and reads no clock.
class SyncClock {
 public:
  /// `cycle` is that of the image: 1 ms to 1 s. `bits`: of the slave's clock, 64 or 32 (0008h bit 3); one of
  /// 32 begins anew every 4.29 s, and is counted on here.
  SyncClock(SlaveAddress slave, Duration cycle, unsigned bits = 64)
      : slave_(slave), cycle_(cycle), bits_(bits) {}

  /// Asks the slave for its time: 8 bytes, or 4, ns.
  Request ask_time() const;
  /// The writes that switch SYNC0 on, at this time of the slave; the first pulse comes 100 ms later, rounded
  /// up to whole cycles. In PRE-OP.
  std::vector<Request> start(std::uint64_t slave_time);
  /// The write that switches it off.
  Request stop() const;

  /// Measures where a cycle of the image lies between two pulses, and moves the next one. To be called after
  /// the image was served.
  void serve(Ring& ring, ProcessImage& image);
  void leave(Ring& ring);
  /// Pulses have begun, and the cycles lie between them.
  bool is_locked() const { return locked_; }
  /// How far the last cycle was from the middle between two pulses; not negative.
  Duration distance() const { return distance_; }

 private:
  void measure(std::uint64_t slave_time, ProcessImage& image);
  std::uint64_t counted_on(std::uint64_t shown);
  std::size_t size() const { return bits_ / 8; }

  SlaveAddress slave_;
  Duration cycle_;
  unsigned bits_;
  std::uint64_t time_ = 0;   ///< Of the slave, seen last, without its wraps.
  std::uint64_t first_ = 0;  ///< Time of the slave at the first pulse.
  std::uint64_t cycles_ = 0;
  std::optional<Ring::Ticket> ticket_;
  Duration distance_{};
  bool locked_ = false;
};

}  // namespace servoctl::ethercat
