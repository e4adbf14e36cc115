#pragma once

#include <memory>
#include <string>

#include "session/network.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {

/// Opens what a URL names: a CAN bus (open_bus()), an EtherCAT ring, `coe:…` (open_port()), or a line with
/// Modbus, `modbus:…` (open_register_line()). Errors as there.
Result<std::unique_ptr<Network>> open_network(const std::string& url, const BusOptions& options);

}  // namespace servoctl::session
