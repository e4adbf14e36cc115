#pragma once

#include <string>

#include "base/bytes.hpp"

namespace servoctl::can {

/// What the kernel answered to one message on a route socket (rtnetlink(7)).
struct RouteAnswer {
  int error = 0;       ///< A value of errno; 0: done. ETIMEDOUT where no answer came.
  std::string words;   ///< What the kernel says of the error in its own words; often nothing.
  Bytes message = {};  ///< What was asked for; empty behind a change.
};

/// Sends one message and waits for what the kernel makes of it. A change is made, or refused, when this
/// returns; a signal does not cut it short.
RouteAnswer ask_route(ByteSpan message);

/// One answer of the kernel taken apart: NLMSG_ERROR with its attributes, or a message.
RouteAnswer parse_route_answer(ByteSpan message);

}  // namespace servoctl::can
