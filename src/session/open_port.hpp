#pragma once

#include <memory>
#include <string_view>

#include "base/result.hpp"
#include "ethernet/port.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {

/// Whether the URL is that of a wire with EtherCAT: `coe:…`.
bool is_ethercat(std::string_view url);

/// Opens a wire with an EtherCAT ring by URL: `coe:sim:sv2@1,sv2@2?state=FILE`.
/// Errc::usage for a URL that is not understood.
Result<std::unique_ptr<ethernet::Port>> open_port(std::string_view url, const BusOptions& options);

}  // namespace servoctl::session
