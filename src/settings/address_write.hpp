#pragma once

#include "settings/address_change.hpp"

namespace servoctl::settings {

/// Writes what leads a drive to its new address, reads it back and stores it; where that fails, the old
/// values are written back. False where it ended with that: `out` says how. Not heard by Ctrl-C.
bool write_address(show::Desk& desk, const AddressChange& change, const AddressOptions& options,
                   AddressOutcome& out);

}  // namespace servoctl::settings
