#pragma once

#include <string_view>

#include "canopen/transfer.hpp"
#include "command/command.hpp"

namespace servoctl::command {

inline constexpr std::string_view kTransferNames[] = {"auto", "expedited", "segmented", "block"};

/// `--transfer`, for the commands that have it.
inline constexpr Parameter kTransferOption{.name = "--transfer",
                                           .help = "SDO transfer type (default: chosen by size)",
                                           .kind = Kind::choice,
                                           .choices = kTransferNames};

/// How a read is to be made: as `--transfer` says; else with block transfer tried first when the object is
/// expected to be `large` and the drive family knows block transfer.
canopen::Transfer read_transfer(const Context& context, const Arguments& arguments, bool large);

/// How `size` bytes are to be written: as `--transfer` says, else by size and by what the family knows.
/// Errc::usage when they cannot be written like that.
Result<canopen::Transfer> write_transfer(const Context& context, const Arguments& arguments,
                                         std::size_t size);

}  // namespace servoctl::command
