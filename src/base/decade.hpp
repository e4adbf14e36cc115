#pragma once

namespace servoctl {

/// Ten to the power of a whole number, as near as a double can be: `1e-3`, `1e6`. Beyond what a double holds:
/// 0 or infinity.
double power_of_ten(int exponent);

/// The power of ten at or below a number, exactly where log10() rounds: 0 for 1 to 9.9, -3 for 0.005. The
/// number must be finite and not zero; its sign does not matter.
int decade_of(double value);

}  // namespace servoctl
