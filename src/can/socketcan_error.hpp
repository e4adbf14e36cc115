#pragma once

#include <string>

#include "base/result.hpp"

/// What can go wrong with an interface of the kernel, with the command that mends it.
namespace servoctl::can {

/// The command that brings the interface up, in backquotes.
Message up_command(const std::string& name);

tl::unexpected<Error> interface_no_name(const std::string& name);
tl::unexpected<Error> interface_missing(const std::string& name);
tl::unexpected<Error> interface_is_no_can(const std::string& name);
tl::unexpected<Error> interface_down(const std::string& name);
tl::unexpected<Error> interface_bus_off(const std::string& name);
/// `error` is the errno of a call on a socket that was bound to the interface.
tl::unexpected<Error> interface_lost(const std::string& name, int error);
tl::unexpected<Error> interface_queue_full(const std::string& name);
/// `error` is the errno of a call that made or bound the socket.
tl::unexpected<Error> interface_cannot_open(const std::string& name, int error);

}  // namespace servoctl::can
