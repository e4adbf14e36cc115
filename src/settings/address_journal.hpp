#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "session/identity.hpp"
#include "settings/address_plan.hpp"

namespace servoctl::settings {

/// How far a plan of addresses has come, kept beside its file from the first write to the last drive.
struct AddressJournal {
  std::string checksum;                   ///< Of the text of the plan.
  std::vector<AddressStep> steps;         ///< All, in their order.
  std::size_t done = 0;                   ///< How many of them are.
  bool begun = false;                     ///< The next one may have been written.
  std::vector<std::string> families;      ///< Of each row.
  std::vector<session::Identity> drives;  ///< What each row's drive said it is, before anything was written.
};

/// Where the journal of a plan stands.
std::filesystem::path address_journal_of(const std::filesystem::path& plan);

/// Reads it; empty when there is none. Errc::file for one that cannot be understood or was changed.
Result<std::optional<AddressJournal>> read_address_journal(const std::filesystem::path& path);
/// Writes it; it is on the disk when this returns.
Result<void> write_address_journal(const std::filesystem::path& path, const AddressJournal& journal);

}  // namespace servoctl::settings
