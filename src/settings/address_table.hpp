#pragma once

#include <span>

#include "report/value.hpp"
#include "settings/address_change.hpp"

namespace servoctl::settings {

/// A row for each drive: where it was and is to be, and what came of it; `outcomes` has one for each of
/// `changes`.
report::Table address_table(std::span<const AddressChange> changes, std::span<const AddressOutcome> outcomes);

}  // namespace servoctl::settings
