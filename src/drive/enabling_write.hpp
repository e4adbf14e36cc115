#pragma once

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {

/// Whether a write of these bytes to the object is a controlword that enables a drive.
bool is_enabling_write(ObjectAddress object, ByteSpan data);

/// The parameter by which a write of these bytes to the object energises the motor, or sets it in motion,
/// without the controlword; null where the family's data name none, and without a family.
const PowerParameter* power_parameter(const Profile* profile, ObjectAddress object, ByteSpan data);

}  // namespace servoctl::drive
