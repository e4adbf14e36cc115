#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "canopen/node_id.hpp"

namespace servoctl::canopen {

/// 1 to 127.
std::vector<std::uint8_t> every_node_id();

/// `1`, `1,3` or `1,3,5-8` (decimal, or hexadecimal with 0x): each node-ID once, in ascending order, at least
/// one. Errc::usage with `hint` for anything else, and for a number that is not a node-ID.
Result<std::vector<std::uint8_t>> parse_node_ids(std::string_view text, std::string_view hint);

}  // namespace servoctl::canopen
