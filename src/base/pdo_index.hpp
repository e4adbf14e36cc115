#pragma once

#include <cstdint>
#include <optional>

namespace servoctl {

/// Seen from the drive: it receives an RPDO and transmits a TPDO.
enum class PdoDirection : std::uint8_t { receive, transmit };

/// Whose record stands at an index (CiA 301, 7.5.1): 512 each, RPDOs at 1400h and 1600h, TPDOs at 1800h and
/// 1A00h.
struct PdoPlace {
  PdoDirection direction = PdoDirection::receive;
  std::uint16_t number = 1;  ///< 1..512.
  bool mapping = false;      ///< The mapping record, not the communication record.
};

/// Empty for indexes other than 1400h to 1BFFh.
std::optional<PdoPlace> pdo_at(std::uint16_t index);
bool is_pdo_communication(std::uint16_t index);
bool is_pdo_mapping(std::uint16_t index);

/// Where the record of a PDO stands.
std::uint16_t index_of(const PdoPlace& place);

}  // namespace servoctl
