#include "can/error_frame.hpp"

#include <linux/can/error.h>

#include <numeric>

#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::can {
namespace {

constexpr std::uint32_t kOfTheWire = CAN_ERR_PROT | CAN_ERR_TRX | CAN_ERR_ACK | CAN_ERR_BUSERROR;

/// Where in the frame it was: some controllers tell it by the place alone.
std::optional<WireError> by_place(std::uint8_t place) {
  if (place == CAN_ERR_PROT_LOC_ACK) return WireError::acknowledge;
  if (place == CAN_ERR_PROT_LOC_CRC_SEQ) return WireError::checksum;
  return std::nullopt;
}

std::optional<WireError> by_kind(std::uint8_t kind) {
  if ((kind & CAN_ERR_PROT_STUFF) != 0) return WireError::stuff;
  if ((kind & CAN_ERR_PROT_FORM) != 0) return WireError::form;
  if ((kind & CAN_ERR_PROT_BIT0) != 0) return WireError::dominant;
  if ((kind & CAN_ERR_PROT_BIT1) != 0) return WireError::recessive;
  if ((kind & CAN_ERR_PROT_BIT) != 0) return WireError::bit;
  if ((kind & CAN_ERR_PROT_OVERLOAD) != 0) return WireError::overload;
  return std::nullopt;
}

}  // namespace

std::string_view text(WireError error) {
  switch (error) {
    case WireError::acknowledge: return "no acknowledge";
    case WireError::bit: return "bit error";
    case WireError::dominant: return "dominant bit lost";
    case WireError::recessive: return "recessive bit disturbed";
    case WireError::stuff: return "stuff error";
    case WireError::form: return "form error";
    case WireError::checksum: return "checksum error";
    case WireError::overload: return "overload frame";
    case WireError::transceiver: return "transceiver";
    case WireError::other: return "error of another kind";
  }
  return {};
}

std::optional<WireError> parse_wire_error(const Frame& frame) {
  if (!frame.error || (frame.id & kOfTheWire) == 0) return std::nullopt;
  if ((frame.id & CAN_ERR_ACK) != 0) return WireError::acknowledge;
  if ((frame.id & CAN_ERR_PROT) != 0) {
    if (const auto kind = by_kind(frame.data[2])) return kind;
    if (const auto place = by_place(frame.data[3])) return place;
  }
  if ((frame.id & CAN_ERR_TRX) != 0 && frame.data[4] != 0) return WireError::transceiver;
  // Some drivers mark an overflow of their controller as an error of the bus as well.
  if ((frame.id & CAN_ERR_CRTL) != 0 && frame.data[1] != 0) return std::nullopt;
  return WireError::other;
}

std::size_t WireErrors::damage() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::size_t{0}) - count(WireError::acknowledge) -
         count(WireError::overload);
}

std::string WireErrors::text() const {
  std::string out;
  for (std::size_t i = 0; i < counts_.size(); ++i)
    if (counts_[i] > 0)
      servoctl::append(out, formatted("{} × {}", counts_[i], can::text(static_cast<WireError>(i))), ", ");
  return out;
}

bool while_sending(const Frame& frame) {
  return frame.error && ((frame.id & CAN_ERR_ACK) != 0 ||
                         ((frame.id & CAN_ERR_PROT) != 0 && (frame.data[2] & CAN_ERR_PROT_TX) != 0));
}

std::string_view transceiver_text(const Frame& frame) {
  if (!frame.error || (frame.id & CAN_ERR_TRX) == 0) return {};
  switch (frame.data[4] & 0x0FU) {
    case CAN_ERR_TRX_CANH_NO_WIRE: return "CAN_H is not connected";
    case CAN_ERR_TRX_CANH_SHORT_TO_BAT: return "CAN_H is shorted to the supply";
    case CAN_ERR_TRX_CANH_SHORT_TO_VCC: return "CAN_H is shorted to VCC";
    case CAN_ERR_TRX_CANH_SHORT_TO_GND: return "CAN_H is shorted to ground";
    default: break;
  }
  switch (frame.data[4] & 0xF0U) {
    case CAN_ERR_TRX_CANL_NO_WIRE: return "CAN_L is not connected";
    case CAN_ERR_TRX_CANL_SHORT_TO_BAT: return "CAN_L is shorted to the supply";
    case CAN_ERR_TRX_CANL_SHORT_TO_VCC: return "CAN_L is shorted to VCC";
    case CAN_ERR_TRX_CANL_SHORT_TO_GND: return "CAN_L is shorted to ground";
    case CAN_ERR_TRX_CANL_SHORT_TO_CANH: return "CAN_L is shorted to CAN_H";
    default: return {};
  }
}

}  // namespace servoctl::can
