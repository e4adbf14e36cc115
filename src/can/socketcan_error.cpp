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

std::string missing_hint() {
  const auto present = can_interfaces();
  const auto here = present.empty() ? std::string("this machine has no CAN interface")
                                    : formatted("CAN interfaces: {}", fmt::join(present, ", "));
  return here +
         "; for a USB adapter: plug it in, then `bus up can0 --bitrate 500k`, with the bitrate of the drives; for a virtual bus: `sudo ip link add dev vcan0 type vcan && sudo ip link "
         "set vcan0 up`";
}

}  // namespace

std::string up_command(const std::string& name) {
  if (needs_no_bitrate(name)) return formatted("`bus up {}`", name);
  return formatted("`bus up {} --bitrate 500k`, with the bitrate of the drives", name);
}

tl::unexpected<Error> interface_no_name(const std::string& name) {
  return fail(Errc::usage, formatted("'{}' is not an interface name", name),
              "an interface has 1 to 15 characters, such as can0; `ip link` lists them");
}

tl::unexpected<Error> interface_missing(const std::string& name) {
  return fail(Errc::bus, formatted("there is no interface {}", name), missing_hint());
}

tl::unexpected<Error> interface_is_no_can(const std::string& name) {
  return fail(Errc::bus, formatted("{} is not a CAN interface", name), missing_hint());
}

tl::unexpected<Error> interface_down(const std::string& name) {
  return fail(Errc::bus, formatted("{} is down", name), formatted("bring it up: {}", up_command(name)));
}

tl::unexpected<Error> interface_bus_off(const std::string& name) {
  return fail(
      Errc::bus, formatted("{} is off the bus after too many errors (bus-off)", name),
      formatted(
          "check the bitrate, the cable and the two 120 ohm resistors; then `bus up {}`, which takes it down and up "
          "again",
          name));
}

tl::unexpected<Error> interface_lost(const std::string& name, int error) {
  const auto up = up_command(name);
  if (error == ENETDOWN)
    return fail(Errc::bus, formatted("{} went down", name), formatted("bring it up again: {}", up));
  if (error == ENXIO || error == ENODEV)
    return fail(Errc::bus, formatted("{} went down: the interface is gone", name),
                formatted("was the adapter unplugged? plug it in, then {}", up));
  return fail(Errc::bus, formatted("{} failed: {}", name, system_text(error)),
              formatted("`bus status {}` shows its state", name));
}

tl::unexpected<Error> interface_queue_full(const std::string& name) {
  return fail(
      Errc::bus, formatted("the transmit queue of {} remains full", name),
      formatted(
          "nobody acknowledges its frames, or the queue is too short: is another node on the bus, and the bitrate right? "
          "`doctor {0}` looks; `bus up {0} --txqueuelen 1000` makes it longer",
          name));
}

tl::unexpected<Error> interface_cannot_open(const std::string& name, int error) {
  return fail(Errc::bus, formatted("cannot open {}: {}", name, system_text(error)),
              formatted("`bus status {}` shows its state", name));
}

}  // namespace servoctl::can
