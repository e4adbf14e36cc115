#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace servoctl::cli {

/// The words of a line in the form of CiA 309-3 as a line of ours: `[7] 1 4 r 0x1017 0 u16` becomes
/// `read 0x1017:0 --type u16 -n 4`. Index and sub-index are decimal there unless they begin with 0x; node 0
/// is all nodes; the sequence number is ignored, and the network may only be 1. No words: nothing is to be
/// done. Empty when the line is not of this form; Errc::usage when it is, and is wrong. A bare `start`,
/// `stop`, `preop`, `reset node`, `reset comm`, `r` or `w` is of this form unless a command has that name.
std::optional<Result<std::vector<std::string>>> from_gateway_line(const std::vector<std::string>& words);

}  // namespace servoctl::cli
