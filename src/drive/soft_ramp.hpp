#pragma once

#include <optional>
#include <string_view>

namespace servoctl::drive {

/// The value of a ramp object (6083h, 6084h, 609Ah) with which the speed is reached in `seconds`, in the
/// object's own way of saying it: an acceleration (`rpm/s` for a speed in `rpm`, `inc/s2` for one in
/// `inc/s`), or a time in `ms` that leads to a speed the object does not tell, taken as 3000 rpm and kept
/// within 200 ms and 30 s. Empty when the two units do not fit each other.
std::optional<double> soft_ramp(std::string_view ramp_unit, std::string_view speed_unit, double speed,
                                double seconds);

}  // namespace servoctl::drive
