#pragma once

#include <span>
#include <string>

#include "report/value.hpp"
#include "session/scan.hpp"

namespace servoctl::commands {

/// `gsd600?`, `gsd600`, `gsd600? or ts?`; empty when no family fits.
std::string guess_text(std::span<const session::Guess> guesses);

/// Nodes with their identity and the families that fit.
report::Table identity_table(std::span<const session::Identity> nodes,
                             std::span<const drive::Family> families);

}  // namespace servoctl::commands
