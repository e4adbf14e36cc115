#pragma once

#include <cstdint>
#include <string>

#include "base/result.hpp"

namespace servoctl::session {

/// An error about one drive: `node 3: what`.
Error drive_error(Errc code, std::uint8_t node, const std::string& what, std::string hint = {});

}  // namespace servoctl::session
