#pragma once

#include "od/encoding.hpp"
#include "od/value.hpp"

namespace servoctl::od {

/// Whether it is a number at all: the bits of a real one may be those of infinity, or of none (NaN). True for
/// strings and bytes.
bool is_number(Encoding encoding, const Value& raw);

}  // namespace servoctl::od
