#include "traffic/bus_load.hpp"

#include <algorithm>
#include <utility>

#include "can/wire.hpp"

namespace servoctl::traffic {

void BusLoad::add(const can::Frame& frame, TimePoint time) {
  if (frame.error) return;
  ++frames_;
  const auto bits = bitrate_ == 0 ? 0 : can::bits_on_wire(frame);
  bits_ += bits;
  if (time >= window_begin_ + kWindow) {
    peak_ = std::max(peak_, std::exchange(window_bits_, 0));
    window_begin_ += (time - window_begin_) / kWindow * kWindow;
  }
  window_bits_ += bits;
}

std::optional<double> BusLoad::load(std::uint64_t bits, Duration time) const {
  const auto seconds = std::chrono::duration<double>(time).count();
  if (bitrate_ == 0 || seconds <= 0) return std::nullopt;
  return 100.0 * static_cast<double>(bits) / (seconds * bitrate_);
}

}  // namespace servoctl::traffic
