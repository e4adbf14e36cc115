#pragma once

#include "commands/command.hpp"
#include "commands/frame_log.hpp"

namespace servoctl::commands {

/// `--service` and `--object`, for the commands that have them.
inline constexpr Parameter kServiceOption{
    .name = "--service",
    .help = "only this service, such as sdo (may be given several times)",
    .kind = Kind::choice,
    .choices = kServices,
    .repeats = true};
inline constexpr Parameter kObjectOption{.name = "--object",
                                         .help = "only frames that carry or name this object",
                                         .kind = Kind::object,
                                         .repeats = true};

/// What these options and -n say. Errc::usage for an unknown object.
Result<FrameFilter> frame_filter(const Context& context, const Arguments& arguments);

}  // namespace servoctl::commands
