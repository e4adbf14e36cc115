#include "can/socketcan_error.hpp"

#include <fmt/format.h>
#include <cerrno>
#include <string_view>

#include "base/format.hpp"
#include "can/descriptor.hpp"
#include "can/socketcan.hpp"

namespace servoctl::can {
namespace {

bool needs_no_bitrate(std::string_view name) {
  return name.starts_with("vcan") || name.starts_with("vxcan") || name.starts_with("slcan");
}

Message missing_hint() {
  const auto present = can_interfaces();
  const auto here = present.empty() ? Message("this machine has no CAN interface")
                                    : message("CAN interfaces: {}", NameList{present});
  return here +
         "; for a USB adapter: plug it in, then `bus up can0 --bitrate 500k`, with the bitrate of the drives; for a virtual bus: `sudo ip link add dev vcan0 type vcan && sudo ip link "
         "set vcan0 up`";
}

}  // namespace

Message up_command(const std::string& name) {
  if (needs_no_bitrate(name)) return message("`bus up {}`", as_it_is(name));
  return message("`bus up {} --bitrate 500k`, with the bitrate of the drives", as_it_is(name));
}

tl::unexpected<Error> interface_no_name(const std::string& name) {
  return fail(Errc::usage, message("'{}' is not an interface name", as_it_is(name)),
              "an interface has 1 to 15 characters, such as can0; `ip link` lists them");
}

tl::unexpected<Error> interface_missing(const std::string& name) {
  return fail(Errc::bus, message("there is no interface {}", as_it_is(name)), missing_hint());
}

tl::unexpected<Error> interface_is_no_can(const std::string& name) {
  return fail(Errc::bus, message("{} is not a CAN interface", as_it_is(name)), missing_hint());
}

tl::unexpected<Error> interface_down(const std::string& name) {
  return fail(Errc::bus, message("{} is down", as_it_is(name)), message("bring it up: {}", up_command(name)));
}

tl::unexpected<Error> interface_bus_off(const std::string& name) {
  return fail(
      Errc::bus, message("{} is off the bus after too many errors (bus-off)", as_it_is(name)),
      message(
          "check the bitrate, the cable and the two 120 ohm resistors; then `bus up {}`, which takes it down and up "
          "again",
          as_it_is(name)));
}

tl::unexpected<Error> interface_lost(const std::string& name, int error) {
  const auto up = up_command(name);
  if (error == ENETDOWN)
    return fail(Errc::bus, message("{} went down", as_it_is(name)), message("bring it up again: {}", up));
  if (error == ENXIO || error == ENODEV)
    return fail(Errc::bus, message("{} went down: the interface is gone", as_it_is(name)),
                message("was the adapter unplugged? plug it in, then {}", up));
  return fail(Errc::bus, message("{} failed: {}", as_it_is(name), system_text(error)),
              message("`bus status {}` shows its state", as_it_is(name)));
}

tl::unexpected<Error> interface_queue_full(const std::string& name) {
  return fail(
      Errc::bus, message("the transmit queue of {} remains full", as_it_is(name)),
      message(
          "nobody acknowledges its frames, or the queue is too short: is another node on the bus, and the bitrate right? "
          "`doctor {0}` looks; `bus up {0} --txqueuelen 1000` makes it longer",
          as_it_is(name)));
}

tl::unexpected<Error> interface_cannot_open(const std::string& name, int error) {
  return fail(Errc::bus, message("cannot open {}: {}", as_it_is(name), system_text(error)),
              message("`bus status {}` shows its state", as_it_is(name)));
}

}  // namespace servoctl::can
