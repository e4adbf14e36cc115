#pragma once

namespace servoctl {

/// Ten to the power of a whole number, as near as a double can be: `1e-3`, `1e6`. Beyond what a double holds:
/// 0 or infinity. (pow() and log10() would bring in the shared libm, the loading of which a one-shot command
/// pays for.)
double power_of_ten(int exponent);

/// The power of ten at or below a number: 0 for 1 to 9.9, -3 for 0.005. The number must be finite and not
/// zero; its sign does not matter.
int decade_of(double value);

}  // namespace servoctl
