#pragma once

#include <cstdint>
#include <string>

#include "base/object_address.hpp"

namespace servoctl::ethercat {

/// What the user can do about an SDO abort over EtherCAT: as canopen::sdo_abort_hint(), except where that
/// speaks of CAN. `writes`: the object was to be written.
std::string coe_abort_hint(std::uint32_t code, ObjectAddress object, bool writes);

}  // namespace servoctl::ethercat
