#include "session/foreign_writes.hpp"

#include <optional>
#include <utility>

#include "canopen/cob_id.hpp"

namespace servoctl::session {
namespace {

/// In the first frame of a write (CiA 301, 7.2.4.3: command specifier 1, or 6 for a block).
std::optional<ObjectAddress> object_written(const can::Frame& frame, std::uint8_t node) {
  if (frame.extended || frame.remote || frame.error || frame.size != 8 ||
      frame.id != static_cast<std::uint32_t>(canopen::kSdoRequest) + node)
    return std::nullopt;
  const auto command = frame.data[0] >> 5U;
  if (command != 1 && !(command == 6 && (frame.data[0] & 1U) == 0)) return std::nullopt;
  return ObjectAddress{static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U), frame.data[3]};
}

}  // namespace

ForeignWrites::ForeignWrites(Session& session, std::uint8_t node, OnWrite on_write)
    : hearing_(session, [node, on_write = std::move(on_write)](const can::Frame& frame, TimePoint) {
        if (const auto object = object_written(frame, node)) on_write(*object);
      }) {}

}  // namespace servoctl::session
