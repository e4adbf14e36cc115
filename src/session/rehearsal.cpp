#include "session/rehearsal.hpp"

#include <algorithm>

#include "base/duration.hpp"
#include "base/format.hpp"

namespace servoctl::session {

PlannedMessage planned_write(SdoRequest request, std::string when) {
  const auto node = request.node;
  return {.node = node, .write = std::move(request), .when = std::move(when)};
}

PlannedMessage planned_state(std::uint8_t node, NodeState state, std::string when) {
  return {.node = node, .state = state, .when = std::move(when)};
}

PlannedMessage planned_life_sign(std::uint8_t node, const LifeSign& sign) {
  return {.node = node, .life_sign = sign, .when = formatted("every {}", servoctl::to_string(sign.period))};
}

void Rehearsal::add(PlannedMessage message) {
  message.step = step_;
  messages_.push_back(std::move(message));
}

const Bytes* Rehearsal::held(ObjectAddress object) const {
  const auto last = std::find_if(messages_.rbegin(), messages_.rend(), [&](const PlannedMessage& message) {
    return message.write && message.write->object == object;
  });
  return last == messages_.rend() ? nullptr : &*last->write->data;
}

}  // namespace servoctl::session
