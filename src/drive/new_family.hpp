#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "drive/foreign_table.hpp"
#include "od/eds.hpp"

namespace servoctl::drive {

/// A family that is made from a data sheet and from tables, before it is written.
struct NewFamily {
  std::string name;
  std::vector<std::pair<std::string, std::string>> files;  ///< Name without folder, content.
  std::vector<std::string> identity;  ///< What the rules recognise the drive by, `0x1018:01 = 0x1234`.
  std::vector<std::string> open;      ///< Keys that a person has to decide.
};

/// Whether it can be the name of a family: lower case letters, digits, `_` and `-`, and no word that means
/// something else where a family is named. Errc::usage.
Result<void> check_family_name(std::string_view name);

/// The rules that the data sheet allows to state, with a comment for each that a person has to decide.
/// `source` is the name of the data sheet, for the comments.
std::string rules_of_sheet(const od::EdsFile& sheet, std::string_view source, NewFamily& family);

/// Writes all files into a folder of the family's name in `folder`, in one step: it is there whole or not at
/// all. What is written is checked first (mistakes_of()). Errc::usage where the folder exists, Errc::file
/// where it cannot be written or the check finds errors. Returns the new folder.
Result<std::filesystem::path> write_family(const NewFamily& family, const std::filesystem::path& folder,
                                           std::span<const std::filesystem::path> folders);

/// The same checks, with nothing written but a temporary folder, which is removed.
Result<std::filesystem::path> try_family(const NewFamily& family, const std::filesystem::path& folder,
                                         std::span<const std::filesystem::path> folders);

}  // namespace servoctl::drive
