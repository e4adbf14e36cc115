#include "ethercat/coe_message.hpp"

#include <algorithm>

#include "ethercat/words.hpp"

namespace servoctl::ethercat {

CoeService coe_service(ByteSpan message) {
  if (message.size() < kCoeHeader) return CoeService::none;
  return static_cast<CoeService>(message[1] >> 4U);
}

Bytes sdo_message(std::uint8_t command, ObjectAddress object, std::uint32_t data) {
  Bytes out(kCoeHeader + kSdoHeader);
  out[1] = static_cast<std::uint8_t>(static_cast<unsigned>(CoeService::sdo_request) << 4U);
  out[2] = command;
  store_le(object.index, std::span(out).subspan(3, 2));
  out[5] = object.sub;
  store_le(data, std::span(out).subspan(6, 4));
  return out;
}

ObjectAddress sdo_object(ByteSpan message) { return {word_at(message, 3), message[5]}; }

std::uint32_t sdo_data(ByteSpan message) { return dword_at(message, 6); }

std::optional<canopen::Emergency> coe_emergency(ByteSpan message, std::uint8_t node) {
  if (message.size() < kCoeHeader + 2) return std::nullopt;
  const auto data = message.subspan(kCoeHeader, std::min<std::size_t>(message.size() - kCoeHeader, 8));
  canopen::Emergency out;
  out.node = node;
  out.code = word_at(data, 0);
  if (data.size() > 2) out.error_register = data[2];
  if (data.size() > 3) std::copy(data.begin() + 3, data.end(), out.vendor.begin());
  out.size = static_cast<std::uint8_t>(data.size());
  return out;
}

}  // namespace servoctl::ethercat
