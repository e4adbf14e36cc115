#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/settings.hpp"
#include "cli/shell.hpp"

namespace servoctl::cli {

/// Where a line that is being typed goes, as far as it can be told without asking a drive.
struct BegunPlace {
  Settings settings;       ///< What the options before the cursor say, over the defaults.
  std::string family;      ///< As after -d; empty: not known.
  bool turn_said = false;  ///< --turn stands in the line, or the cabinet file says it of its axes.
  bool in_shell = false;   ///< It is the line of a shell, which knows files itself, and what `~/` is.
};

/// Reads --bus, --node, --drive, --cabinet, --lang and --turn among the words. The family is that of -d, of
/// the axes of the cabinet file, of the drives that sim: names, or what was said of the drive at this bus and
/// node in an earlier line.
BegunPlace begun_place(const std::vector<std::string>& words, Shell& shell);

/// Where in a URL simulated drives are named, behind `sim:`, `coe:sim:` or `modbus:sim:`; empty for any
/// other.
std::optional<std::size_t> cell_begin(std::string_view url);

/// The one family that the cabinet file says of the nodes of the settings; empty where they are no axes of
/// one family, or there is no such file.
std::string family_in_cabinet(const Settings& settings, Shell& shell);

}  // namespace servoctl::cli
