#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "canopen/emergency.hpp"

namespace servoctl::ethercat {

/// What a CoE message is (ETG.1000.6, table 29).
enum class CoeService : std::uint8_t {
  none = 0,
  emergency = 1,
  sdo_request = 2,
  sdo_response = 3,
  tx_pdo = 4,
  rx_pdo = 5,
  tx_pdo_request = 6,
  rx_pdo_request = 7,
  sdo_info = 8,
};

inline constexpr std::size_t kCoeHeader = 2;
inline constexpr std::size_t kSdoHeader = 8;  ///< Behind kCoeHeader: as on CAN, 8 bytes.

CoeService coe_service(ByteSpan message);  ///< `none` for a message that is too short.

/// The 10 bytes of a request: command, object and 4 bytes of data.
Bytes sdo_message(std::uint8_t command, ObjectAddress object, std::uint32_t data);
/// Object of a message of at least 10 bytes that has one.
ObjectAddress sdo_object(ByteSpan message);
std::uint32_t sdo_data(ByteSpan message);

/// The emergency of a message of that service; empty when it is too short for an error code.
std::optional<canopen::Emergency> coe_emergency(ByteSpan message, std::uint8_t node);

}  // namespace servoctl::ethercat
