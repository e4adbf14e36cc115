#pragma once

#include "base/bytes.hpp"
#include "base/object_address.hpp"

namespace servoctl::drive {

/// Whether a write of these bytes to the object is a controlword that enables a drive.
bool is_enabling_write(ObjectAddress object, ByteSpan data);

}  // namespace servoctl::drive
