#include "od/real_number.hpp"

#include <cmath>

namespace servoctl::od {

bool is_number(Encoding encoding, const Value& raw) { return std::isfinite(decode_number(encoding, raw)); }

}  // namespace servoctl::od
