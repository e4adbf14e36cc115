#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "drive/profile.hpp"

namespace servoctl::drive {

/// What people call one thing, in either language, whatever a manual calls it.
struct EverydayWords {
  std::string name;  ///< `braking resistor`
  std::vector<std::string>
      words;            ///< `brake resistor`, `制动电阻`, `vibrat`: what a word begins with is enough.
  bool absent = false;  ///< The manual of the family says nothing of it.
  bool operator==(const EverydayWords&) const = default;
};

/// Reads `<family>.words.csv` (docs/drive-data.md). Errc::file with file and line for an unknown column or
/// cell, a thing without a name, one that appears twice.
Result<std::vector<EverydayWords>> parse_everyday_words(std::string_view csv, std::string_view file);
/// The same; adds everything that is wrong to `errors`.
std::vector<EverydayWords> read_everyday_words(std::string_view csv, std::string_view file,
                                               std::vector<Error>& errors);

/// The words of the standard, with those that the family and its parents add. Errors as above.
Result<std::vector<EverydayWords>> load_everyday_words(const Profile& profile,
                                                       std::span<const std::filesystem::path> folders);

}  // namespace servoctl::drive
