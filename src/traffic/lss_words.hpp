#pragma once

#include <string>

#include "can/frame.hpp"

namespace servoctl::traffic {

/// What a frame of LSS (CiA 305) says, in words: `LSS set node-ID 5`, `LSS slave: node-ID set`. `frame` has
/// one of the two identifiers of LSS.
std::string lss_text(const can::Frame& frame);

}  // namespace servoctl::traffic
