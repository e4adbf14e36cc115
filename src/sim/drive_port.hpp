#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "base/object_address.hpp"

namespace servoctl::sim {

/// What a wire has to say of the objects that set it up. A drive knows them as numbers; what they mean, and
/// when they may change, its port knows.
class DrivePort {
 public:
  DrivePort() = default;
  DrivePort(const DrivePort&) = delete;
  DrivePort& operator=(const DrivePort&) = delete;
  virtual ~DrivePort() = default;

  /// Abort code when an object that the drive itself would take is not to hold this now, or 0.
  virtual std::uint32_t check_write(ObjectAddress object, ByteSpan data) const = 0;
  /// An object holds a new value.
  virtual void on_written(ObjectAddress object) = 0;
};

}  // namespace servoctl::sim
