#pragma once

#include <cstdint>
#include <functional>

#include "base/object_address.hpp"
#include "session/hearing.hpp"

namespace servoctl::session {

/// While it lives, reports each object of one node that another master starts to write. Where servoctl is the
/// only master, as it is on any network but CAN, there is nothing to tell.
class ForeignWrites {
 public:
  using OnWrite = std::function<void(ObjectAddress object)>;

  ForeignWrites(Session& session, std::uint8_t node, OnWrite on_write);

 private:
  Hearing hearing_;
};

}  // namespace servoctl::session
