#include "canopen/sdo_frame.hpp"

#include <span>

#include "base/bytes.hpp"
#include "canopen/cob_id.hpp"

namespace servoctl::canopen {

can::Frame sdo_frame(std::uint32_t cob_id, std::uint8_t command, ObjectAddress object, std::uint32_t data) {
  auto frame = sdo_segment(cob_id, command);
  frame.data[1] = static_cast<std::uint8_t>(object.index);
  frame.data[2] = static_cast<std::uint8_t>(object.index >> 8U);
  frame.data[3] = object.sub;
  store_le(data, std::span(frame.data).subspan(4));
  return frame;
}

can::Frame sdo_segment(std::uint32_t cob_id, std::uint8_t command) {
  can::Frame frame;
  frame.id = cob_id;
  frame.size = 8;
  frame.data[0] = command;
  return frame;
}

ObjectAddress sdo_object(const can::Frame& frame) {
  return {static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U), frame.data[3]};
}

std::uint32_t sdo_data(const can::Frame& frame) {
  return static_cast<std::uint32_t>(load_le(std::span(frame.data).subspan(4)));
}

std::optional<SdoWriteRequest> sdo_write_request(const can::Frame& frame) {
  if (frame.extended || frame.remote || frame.error || frame.size != 8 || frame.id <= kSdoRequest ||
      frame.id > kSdoRequest + kLastNode)
    return std::nullopt;
  const auto command = frame.data[0] >> 5U;
  const bool begins_block = command == 6 && (frame.data[0] & 1U) == 0;
  if (command != 1 && !begins_block) return std::nullopt;
  return SdoWriteRequest{static_cast<std::uint8_t>(frame.id - kSdoRequest), sdo_object(frame)};
}

}  // namespace servoctl::canopen
