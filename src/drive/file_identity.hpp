#pragma once

#include <vector>

#include "drive/rules.hpp"
#include "od/eds.hpp"

namespace servoctl::drive {

/// What an EDS or DCF says of the identity of its device: [DeviceInfo] and the constant defaults of 1000h,
/// 1008h and 1018h. Zero, "0" and nothing are no statement; where [DeviceInfo] and the default of 1018h
/// differ, neither is. The revision is soft: another firmware is the same kind of device. Of an ESI, vendor,
/// product code and revision of the device alone.
std::vector<IdentityMark> identity_marks(const od::EdsFile& file);

}  // namespace servoctl::drive
