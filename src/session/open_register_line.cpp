#include "session/open_register_line.hpp"

#include "base/format.hpp"
#include "modbus/serial_port.hpp"
#include "modbus/tcp_port.hpp"
#include "sim/modbus_port.hpp"

namespace servoctl::session {
namespace {

constexpr std::string_view kModbus = "modbus:";
constexpr std::string_view kTcp = "//";
constexpr std::string_view kSimulated = "sim:";
constexpr std::string_view kModbusForms =
    "write modbus:/dev/ttyUSB0@19200,8E1, modbus://HOST:502 or modbus:sim:FAMILY@1";

Result<void> check_register_url(std::string_view url, const BusOptions& options) {
  if (!is_modbus(url) || url.size() == kModbus.size())
    return fail(Errc::usage, message("'{}' is not a Modbus line", as_it_is(url)), std::string(kModbusForms));
  if (!options.trace.empty())
    return fail(Errc::usage, "--trace records frames of CAN and EtherCAT; there is no trace of Modbus",
                "leave --trace out");
  return {};
}

/// What begins with neither is a name without a folder: `modbus:ttyUSB0`, or a scheme that there is not.
Result<void> check_device(std::string_view rest) {
  if (rest.starts_with('/') || rest.starts_with('.')) return {};
  return fail(Errc::usage, message("'{}' is neither a serial port nor a host", as_it_is(rest)),
              std::string(kModbusForms));
}

}  // namespace

bool is_modbus(std::string_view url) { return url.starts_with(kModbus); }

std::vector<std::string> modbus_urls() {
  std::vector<std::string> out;
  for (const auto& port : can::serial_adapters()) out.push_back(std::string(kModbus) + port);
  for (const auto form : {kTcp, kSimulated}) out.push_back(std::string(kModbus) + std::string(form));
  return out;
}

Result<std::unique_ptr<modbus::Port>> open_register_line(std::string_view url, const BusOptions& options) {
  if (const auto checked = check_register_url(url, options); !checked) return fail(checked.error());
  const auto rest = url.substr(kModbus.size());
  if (rest.starts_with(kSimulated))
    return sim::open_modbus_sim(rest.substr(kSimulated.size()), options.drive_folders, options.clock);
  if (rest.starts_with(kTcp)) {
    const auto address = modbus::parse_tcp(rest.substr(kTcp.size()));
    if (!address) return fail(address.error());
    return modbus::open_tcp(*address);
  }
  if (const auto named = check_device(rest); !named) return fail(named.error());
  const auto settings = modbus::parse_serial(rest);
  if (!settings) return fail(settings.error());
  return modbus::open_serial(*settings);
}

Result<std::unique_ptr<modbus::Listener>> open_register_listener(std::string_view url,
                                                                 const BusOptions& options) {
  if (const auto checked = check_register_url(url, options); !checked) return fail(checked.error());
  const auto rest = url.substr(kModbus.size());
  if (rest.starts_with(kSimulated))
    return fail(Errc::usage, "a simulated drive cannot be put on a line that is simulated itself",
                "use one that others can reach: modbus://127.0.0.1:1502, or one end of a pseudo-terminal");
  if (rest.starts_with(kTcp)) {
    const auto address = modbus::parse_tcp(rest.substr(kTcp.size()));
    if (!address) return fail(address.error());
    return modbus::listen_tcp(*address);
  }
  if (const auto named = check_device(rest); !named) return fail(named.error());
  const auto settings = modbus::parse_serial(rest);
  if (!settings) return fail(settings.error());
  return modbus::listen_serial(*settings);
}

}  // namespace servoctl::session
