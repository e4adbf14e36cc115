#include "session/own_bitrate.hpp"

#include <string>

#include "base/format.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {
namespace {

/// The command as it is typed on the machine that has the interface.
std::string typed_there(std::string_view command, std::string_view interface_name) {
  return formatted("{}{}{}", command, command == "bus detect" ? " " : " -b ", interface_name);
}

}  // namespace

Result<void> check_own_bitrate(std::string_view url, std::string_view command) {
  const auto scheme = url.substr(0, url.find(':'));
  if (scheme == url || scheme == "socketcan" || scheme == "slcan") return {};
  if (scheme == "socketcand")
    return fail(
        Errc::usage, message("the bitrate of {} is set on the machine that has the interface", as_it_is(url)),
        message("run servoctl there: `{}`", as_it_is(typed_there(command, url.substr(url.rfind('/') + 1)))));
  if (scheme == "gateway")
    return fail(
        Errc::usage, message("the bitrate of the bus behind {} is set where the gateway runs", as_it_is(url)),
        message("end the gateway, and run servoctl there: `{}`", as_it_is(typed_there(command, "can0"))));
  if (scheme == "modbus")
    return fail(
        Errc::usage,
        message("{}: devices with Modbus are silent until they are asked, and listening finds nothing",
                as_it_is(url)),
        "ask at each speed and parity that they may have, and see at which they answer: `scan -b "
        "modbus:/dev/ttyUSB0@9600,8E1`, then @19200,8E1, @9600,8N1 and so on; over TCP there is no speed to find");
  if (scheme == "coe")
    return fail(Errc::usage,
                message("{}: EtherCAT has one speed, 100 Mbit/s, and none to find", as_it_is(url)),
                message("`doctor -b {}` looks at its links", as_it_is(url)));
  return fail(Errc::usage, message("{} has no bitrate to find", as_it_is(url)),
              "only an interface of the kernel (can0) and an adapter behind slcan: have one");
}

}  // namespace servoctl::session
