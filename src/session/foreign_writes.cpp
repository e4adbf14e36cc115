#include "session/foreign_writes.hpp"

#include <utility>

#include "canopen/sdo_frame.hpp"

namespace servoctl::session {

ForeignWrites::ForeignWrites(Session& session, std::uint8_t node, OnWrite on_write)
    : hearing_(session, [node, on_write = std::move(on_write)](const can::Frame& frame, TimePoint) {
        if (const auto write = canopen::sdo_write_request(frame); write && write->node == node)
          on_write(write->object);
      }) {}

}  // namespace servoctl::session
