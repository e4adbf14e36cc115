#pragma once

#include <span>

#include "report/value.hpp"
#include "settings/address_change.hpp"
#include "settings/address_journal.hpp"

namespace servoctl::settings {

/// A row for each drive: where it was and is to be, and what came of it; `outcomes` has one for each of
/// `changes`.
report::Table address_table(std::span<const AddressChange> changes, std::span<const AddressOutcome> outcomes);

/// The steps of a plan that are still to be done, as a question shows them.
report::Table address_steps(std::span<const AddressRow> rows, const AddressJournal& journal);

}  // namespace servoctl::settings
