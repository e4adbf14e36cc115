#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "drive/profile.hpp"
#include "session/session.hpp"
#include "settings/address_journal.hpp"

namespace servoctl::settings {

/// How far a plan has come: what its journal tells where it is to be resumed, else nothing yet. Errc::refused
/// for one that was interrupted and is not resumed, and where the plan has changed since; Errc::usage where
/// there is nothing to resume; errors of read_address_journal().
Result<AddressJournal> begin_address_journal(const std::filesystem::path& plan, std::string checksum,
                                             std::size_t rows, bool resume);

/// Finds out whether the step that was under way when the plan was interrupted was done, and notes it in the
/// journal: the drive is at one of the step's two ends. Errc::refused when somebody is at both, Errc::timeout
/// when it is at neither; errors of the bus.
Result<void> settle_address_step(session::Session& session, AddressJournal& journal);

/// Where the drive of a row stands by the steps that are done, and whether it is to move yet.
std::uint8_t place_of_row(const AddressRow& row, const AddressJournal& journal, std::size_t number);
bool has_steps_left(const AddressJournal& journal, std::size_t row);

/// Errc::refused where a row has another family than when the plan was begun.
Result<void> same_families(std::span<const AddressRow> rows, std::span<const drive::Profile* const> profiles,
                           const AddressJournal& journal);

/// Of a drive that moves only when somebody switches it off and on; and an error with the line of its row.
Error awaits_power(const AddressStep& step);
Error with_row(const AddressRow& row, Error error);

}  // namespace servoctl::settings
