#pragma once

#include "session/session.hpp"
#include "settings/address_journal.hpp"

namespace servoctl::settings {

/// Finds out whether the step that was under way when the plan was interrupted was done, and notes it in the
/// journal: the drive is at one of the step's two ends. Errc::refused when somebody is at both, Errc::timeout
/// when it is at neither; errors of the bus.
Result<void> settle_address_step(session::Session& session, AddressJournal& journal);

/// Where the drive of a row stands by the steps that are done, and whether it is to move yet.
std::uint8_t place_of_row(const AddressRow& row, const AddressJournal& journal, std::size_t number);
bool has_steps_left(const AddressJournal& journal, std::size_t row);

/// Of a drive that moves only when somebody switches it off and on; and an error with the line of its row.
Error awaits_power(const AddressStep& step);
Error with_row(const AddressRow& row, Error error);

}  // namespace servoctl::settings
