#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drive/profile.hpp"

namespace servoctl::drive {

/// One thing that is wrong in a file of a family.
struct Mistake {
  std::string file;  ///< Without its folder.
  std::optional<std::uint32_t> line;
  bool breaks = true;  ///< False: the family works; something of the file is not used, or taken otherwise.
  Message message;     ///< `p10.toml:14:1: unknown key 'waers'`
  Message remedy;      ///< What would be right; empty where the message says it.
};

/// Everything that is wrong in all files of a family, file by file and by line; empty: it is sound. Of a file
/// that is no TOML only the first fault of its form is known, and nothing of what it says.
std::vector<Mistake> mistakes_of(const Family& family, std::span<const std::filesystem::path> folders);

/// How many of them break the family.
std::size_t count_errors(std::span<const Mistake> mistakes);

/// Adds an error for every name in a rules file that is neither a parameter nor an object of the profile.
void check_rule_names(std::string_view toml, std::string_view file, const Profile& profile,
                      std::vector<Error>& errors);

}  // namespace servoctl::drive
