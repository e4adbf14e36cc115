#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "session/life_sign.hpp"
#include "session/node_state.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// One message that would be sent: a write, the request of a state, or a sign of life.
struct PlannedMessage {
  std::uint8_t node = 0;
  std::optional<SdoRequest> write = {};
  std::optional<NodeState> state = {};
  std::optional<LifeSign> life_sign = {};
  std::string when = {};  ///< Sent only then, or so often; empty: once, in any case.
  std::string step = {};  ///< What it is part of: `mode`, `enable`; may be empty.
};

PlannedMessage planned_write(SdoRequest request, std::string when = {});
PlannedMessage planned_state(std::uint8_t node, NodeState state, std::string when = {});
/// Sent once a period.
PlannedMessage planned_life_sign(std::uint8_t node, const LifeSign& sign);

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
