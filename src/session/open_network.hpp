#pragma once

#include <memory>
#include <string>

#include "session/network.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {

/// Opens what a URL names: a CAN bus (open_bus()), or an EtherCAT ring, `coe:…` (open_port()). Errors as
/// there.
Result<std::unique_ptr<Network>> open_network(const std::string& url, const BusOptions& options);

}  // namespace servoctl::session
