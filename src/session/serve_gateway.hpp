#pragma once

#include "gateway/listener.hpp"
#include "session/gateway_server.hpp"

namespace servoctl::session {

/// Lets clients ask until the session is cancelled, which is no error. Errc::bus when its network is lost.
/// A client that does not read its answers for half a minute is dropped. Where sixteen are there and another
/// comes, the one goes that has said nothing for ten seconds, or for longest; else the newcomer.
Result<void> serve_gateway(Session& session, gateway::Listener& listener, GatewayServer& server);

}  // namespace servoctl::session
