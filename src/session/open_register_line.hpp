#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "modbus/listener.hpp"
#include "modbus/port.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {

/// Whether the URL is that of a line with Modbus: `modbus:…`.
bool is_modbus(std::string_view url);

/// What URLs of such lines begin with on this machine: `modbus:/dev/ttyUSB0`, `modbus://`, `modbus:sim:`.
std::vector<std::string> modbus_urls();

/// Opens a line as who asks: `modbus:/dev/ttyUSB0@19200,8E1`, `modbus://host:502`, `modbus:sim:ts@1`.
/// Errc::usage for a URL that is not understood, and for a trace, which there is none of; else as
/// open_serial(), open_tcp(), open_modbus_sim().
Result<std::unique_ptr<modbus::Port>> open_register_line(std::string_view url, const BusOptions& options);

/// The other end, for who stands for its devices: a serial line, or `modbus://127.0.0.1:1502` to listen at.
Result<std::unique_ptr<modbus::Listener>> open_register_listener(std::string_view url,
                                                                 const BusOptions& options);

}  // namespace servoctl::session
