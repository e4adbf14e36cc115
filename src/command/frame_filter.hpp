#pragma once

#include "command/command.hpp"
#include "traffic/frame_log.hpp"

namespace servoctl::command {

/// `--service` and `--object`, for the commands that have them.
inline constexpr Parameter kServiceOption{
    .name = "--service",
    .help = "only this service, such as sdo (may be given several times)",
    .kind = Kind::choice,
    .choices = traffic::kServices,
    .repeats = true};
inline constexpr Parameter kObjectOption{.name = "--object",
                                         .help = "only frames that carry or address this object",
                                         .kind = Kind::object,
                                         .repeats = true};

/// What these options and -n say. Errc::usage for an unknown object.
Result<traffic::FrameFilter> frame_filter(const Context& context, const Arguments& arguments);

}  // namespace servoctl::command
