#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "can/frame.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// One message that would be sent: a write by SDO, else the frame as it stands.
struct PlannedMessage {
  std::uint8_t node = 0;
  std::optional<SdoRequest> write = {};
  std::optional<can::Frame> frame = {};
  std::string when = {};  ///< Sent only then, or so often; empty: once, in any case.
  std::string step = {};  ///< What it is part of: `mode`, `enable`; may be empty.
};

PlannedMessage planned_write(SdoRequest request, std::string when = {});
PlannedMessage planned_frame(std::uint8_t node, const can::Frame& frame, std::string when = {});

/// What a sequence of steps would send, gone through without sending it.
class Rehearsal {
 public:
  /// What follows is part of this.
  void begin_step(std::string_view name) { step_ = name; }
  void add(PlannedMessage message);
  /// What an object would hold by now; empty when it was not written.
  const Bytes* held(ObjectAddress object) const;
  const std::vector<PlannedMessage>& messages() const { return messages_; }

 private:
  std::string step_;
  std::vector<PlannedMessage> messages_;
};

}  // namespace servoctl::session
