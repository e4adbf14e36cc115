#include "canopen/emergency.hpp"

#include <algorithm>
#include <string_view>

#include "canopen/cob_id.hpp"

namespace servoctl::canopen {
namespace {

struct Row {
  std::uint16_t code;
  std::uint16_t mask;
  std::string_view text;
};

/// The first row that fits wins: single codes stand before their class.
constexpr std::array kRows{
    Row{0x0000, 0xFF00, "error reset or no error"},
    Row{0x1000, 0xFF00, "generic error"},
    Row{0x2000, 0xFF00, "current, generic"},
    Row{0x2100, 0xFF00, "current, input side"},
    Row{0x2200, 0xFF00, "current inside the device"},
    Row{0x2300, 0xFF00, "current, output side"},
    Row{0x3000, 0xFF00, "voltage, generic"},
    Row{0x3100, 0xFF00, "mains voltage"},
    Row{0x3200, 0xFF00, "voltage inside the device"},
    Row{0x3300, 0xFF00, "output voltage"},
    Row{0x4000, 0xFF00, "temperature, generic"},
    Row{0x4100, 0xFF00, "ambient temperature"},
    Row{0x4200, 0xFF00, "device temperature"},
    Row{0x6000, 0xFF00, "device software, generic"},
    Row{0x6100, 0xFF00, "internal software"},
    Row{0x6200, 0xFF00, "user software"},
    Row{0x6300, 0xFF00, "data set"},
    Row{0x8110, 0xFFFF, "CAN overrun: messages lost"},
    Row{0x8120, 0xFFFF, "CAN in error passive mode"},
    Row{0x8130, 0xFFFF, "life guard or heartbeat error"},
    Row{0x8140, 0xFFFF, "recovered from bus-off"},
    Row{0x8150, 0xFFFF, "CAN-ID collision"},
    Row{0x8100, 0xFF00, "communication, generic"},
    Row{0x8210, 0xFFFF, "PDO not processed: length error"},
    Row{0x8220, 0xFFFF, "PDO length exceeded"},
    Row{0x8230, 0xFFFF, "DAM MPDO not processed, destination object not available"},
    Row{0x8240, 0xFFFF, "unexpected SYNC data length"},
    Row{0x8250, 0xFFFF, "RPDO timed out"},
    Row{0x8200, 0xFF00, "protocol error, generic"},
    Row{0x9000, 0xFF00, "external error"},
    Row{0xF000, 0xFF00, "additional functions"},
    Row{0xFF00, 0xFF00, "device specific"},
    Row{0x2000, 0xF000, "current"},
    Row{0x3000, 0xF000, "voltage"},
    Row{0x4000, 0xF000, "temperature"},
    Row{0x5000, 0xF000, "device hardware"},
    Row{0x6000, 0xF000, "device software"},
    Row{0x7000, 0xF000, "additional modules"},
    Row{0x8000, 0xF000, "monitoring"},
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
  for (const auto& row : kRows)
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
