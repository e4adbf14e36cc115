#include "canopen/emergency.hpp"

#include <algorithm>
#include <string_view>

#include "canopen/cob_id.hpp"

namespace servoctl::canopen {
namespace {

struct EmergencyText {
  std::uint16_t code;
  std::uint16_t mask;
  std::string_view text;
};

/// The first row that fits wins: single codes stand before their class.
constexpr std::array kEmergencyTexts{
    EmergencyText{0x0000, 0xFF00, "error reset or no error"},
    EmergencyText{0x1000, 0xFF00, "generic error"},
    EmergencyText{0x2000, 0xFF00, "current, generic"},
    EmergencyText{0x2100, 0xFF00, "current, input side"},
    EmergencyText{0x2200, 0xFF00, "current inside the device"},
    EmergencyText{0x2300, 0xFF00, "current, output side"},
    EmergencyText{0x3000, 0xFF00, "voltage, generic"},
    EmergencyText{0x3100, 0xFF00, "mains voltage"},
    EmergencyText{0x3200, 0xFF00, "voltage inside the device"},
    EmergencyText{0x3300, 0xFF00, "output voltage"},
    EmergencyText{0x4000, 0xFF00, "temperature, generic"},
    EmergencyText{0x4100, 0xFF00, "ambient temperature"},
    EmergencyText{0x4200, 0xFF00, "device temperature"},
    EmergencyText{0x6000, 0xFF00, "device software, generic"},
    EmergencyText{0x6100, 0xFF00, "internal software"},
    EmergencyText{0x6200, 0xFF00, "user software"},
    EmergencyText{0x6300, 0xFF00, "data set"},
    EmergencyText{0x8110, 0xFFFF, "CAN overrun: messages lost"},
    EmergencyText{0x8120, 0xFFFF, "CAN in error passive mode"},
    EmergencyText{0x8130, 0xFFFF, "life guard or heartbeat error"},
    EmergencyText{0x8140, 0xFFFF, "recovered from bus-off"},
    EmergencyText{0x8150, 0xFFFF, "CAN-ID collision"},
    EmergencyText{0x8100, 0xFF00, "communication, generic"},
    EmergencyText{0x8210, 0xFFFF, "PDO not processed: length error"},
    EmergencyText{0x8220, 0xFFFF, "PDO length exceeded"},
    EmergencyText{0x8230, 0xFFFF, "DAM MPDO not processed, destination object not available"},
    EmergencyText{0x8240, 0xFFFF, "unexpected SYNC data length"},
    EmergencyText{0x8250, 0xFFFF, "RPDO timed out"},
    EmergencyText{0x8200, 0xFF00, "protocol error, generic"},
    EmergencyText{0x9000, 0xFF00, "external error"},
    EmergencyText{0xF000, 0xFF00, "additional functions"},
    EmergencyText{0xFF00, 0xFF00, "device specific"},
    EmergencyText{0x2000, 0xF000, "current"},
    EmergencyText{0x3000, 0xF000, "voltage"},
    EmergencyText{0x4000, 0xF000, "temperature"},
    EmergencyText{0x5000, 0xF000, "device hardware"},
    EmergencyText{0x6000, 0xF000, "device software"},
    EmergencyText{0x7000, 0xF000, "additional modules"},
    EmergencyText{0x8000, 0xF000, "monitoring"},
};

constexpr auto kRegisterBits =
    std::to_array<std::string_view>({"generic", "current", "voltage", "temperature", "communication",
                                     "device profile", "reserved", "manufacturer"});

}  // namespace

std::optional<Emergency> parse_emergency(const can::Frame& frame) {
  if (frame.id < kEmergency + kFirstNode || frame.id > kEmergency + kLastNode) return std::nullopt;
  if (frame.extended) return std::nullopt;
  return parse_emergency(frame, static_cast<std::uint8_t>(frame.id - kEmergency));
}

std::optional<Emergency> parse_emergency(const can::Frame& frame, std::uint8_t node) {
  if (frame.size < 2 || frame.remote || frame.error) return std::nullopt;
  Emergency out;
  out.node = node;
  out.code = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8U);
  if (frame.size > 2) out.error_register = frame.data[2];
  if (frame.size > 3) std::copy_n(frame.data.begin() + 3, frame.size - 3, out.vendor.begin());
  out.size = frame.size;
  return out;
}

can::Frame emergency_frame(const Emergency& emergency) {
  can::Frame frame;
  frame.id = kEmergency + emergency.node;
  frame.size = emergency.size;
  frame.data[0] = static_cast<std::uint8_t>(emergency.code);
  frame.data[1] = static_cast<std::uint8_t>(emergency.code >> 8U);
  frame.data[2] = emergency.error_register;
  std::copy(emergency.vendor.begin(), emergency.vendor.end(), frame.data.begin() + 3);
  return frame;
}

std::string emergency_text(std::uint16_t code) {
  for (const auto& row : kEmergencyTexts)
    if ((code & row.mask) == row.code) return std::string(row.text);
  return "not listed in CiA 301";
}

std::string error_register_text(std::uint8_t value) {
  std::string out;
  for (const auto bit : kRegisterBits) {
    const bool is_set = (value & 1U) != 0;
    value = static_cast<std::uint8_t>(value >> 1U);
    if (!is_set) continue;
    if (!out.empty()) out += ", ";
    out += bit;
  }
  return out.empty() ? "none" : out;
}

}  // namespace servoctl::canopen
