#pragma once

#include <optional>

#include "base/time.hpp"
#include "can/frame.hpp"

namespace servoctl::sim {

/// A node on a bus, free of I/O and clock like the protocol machines: give it frames and time, take frames
/// from it.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  virtual void on_frame(const can::Frame& frame, TimePoint now) = 0;
  virtual void on_time(TimePoint now) = 0;
  virtual std::optional<can::Frame> take_frame() = 0;
  virtual TimePoint deadline()
      const = 0;  ///< When on_time() has something to do; kNever if nothing is planned.
};

}  // namespace servoctl::sim
