#include "od/complex_type.hpp"

#include <array>

namespace servoctl::od {

bool is_complex_type(std::uint64_t code) {
  return (code >= 0x20 && code <= 0x25) || (code >= 0x40 && code <= 0x25F);
}

std::string cia_name(std::uint64_t code) {
  constexpr std::array kNames{"PDO_COMMUNICATION_PARAMETER",
                              "PDO_MAPPING",
                              "SDO_PARAMETER",
                              "IDENTITY",
                              "OS_DEBUG_RECORD",
                              "OS_COMMAND_RECORD"};
  if (code >= 0x20 && code < 0x20 + kNames.size()) return kNames[code - 0x20];
  return code < 0x60 ? "type of the manufacturer" : "type of the device profile";
}

}  // namespace servoctl::od
