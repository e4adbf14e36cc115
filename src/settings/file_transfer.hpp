#pragma once

#include <filesystem>
#include <span>

#include "settings/change.hpp"
#include "show/desk.hpp"

/// Objects of any size that go into a file or come from one, byte for byte.
namespace servoctl::settings {

/// Reads the object and puts its bytes into the file, in one step.
Result<report::Value> read_to_file(show::Desk& desk, std::uint8_t node, const drive::Target& target,
                                   canopen::Transfer transfer, const std::filesystem::path& file);

/// The change that puts the content of the file into the object. Errc::file when it cannot be read,
/// Errc::usage for a read-only object, one of another fixed size, and a COB-ID that no drive may have.
Result<Change> change_from_file(const drive::Profile* profile, std::uint8_t node, const drive::Target& target,
                                const std::filesystem::path& file);

/// Makes the changes and reports how many bytes went where, and whether they are kept. Failures go to
/// `desk.errors`.
Result<report::Value> write_from_file(show::Desk& desk, std::span<const Change> changes,
                                      const std::filesystem::path& file, const WriteOptions& options);

}  // namespace servoctl::settings
