#pragma once

#include <cstdint>
#include <string>

namespace servoctl::od {

/// Whether a DataType of this number is a type without a plain value: 0020h-0025h and 0040h-025Fh, records of
/// CiA 301 and types of manufacturers and device profiles (CiA 301, table 44). data_type_from_cia() takes
/// them as domains: bytes whose order only their definition tells.
bool is_complex_type(std::uint64_t code);

/// `PDO_MAPPING`, `type of the manufacturer`: what a complex type is called.
std::string cia_name(std::uint64_t code);

}  // namespace servoctl::od
