#include "session/open_network.hpp"

#include "session/can_network.hpp"
#include "session/ethercat_network.hpp"
#include "session/gateway_network.hpp"
#include "session/modbus_network.hpp"
#include "session/open_port.hpp"
#include "session/open_register_line.hpp"

namespace servoctl::session {

Result<std::unique_ptr<Network>> open_network(const std::string& url, const BusOptions& options) {
  if (is_ethercat(url)) {
    auto port = open_port(url, options);
    if (!port) return fail(port.error());
    return std::make_unique<EtherCatNetwork>(std::move(*port), url);
  }
  if (is_gateway(url)) {
    auto gateway = GatewayNetwork::open(url, options);
    if (!gateway) return fail(gateway.error());
    return std::move(*gateway);
  }
  if (is_modbus(url)) {
    auto line = open_register_line(url, options);
    if (!line) return fail(line.error());
    return std::make_unique<ModbusNetwork>(std::move(*line), url);
  }
  auto bus = open_bus(url, options);
  if (!bus) return fail(bus.error());
  return std::make_unique<CanNetwork>(std::move(*bus), url);
}

}  // namespace servoctl::session
