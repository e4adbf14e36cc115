#pragma once

#include <map>
#include <string>

#include "commands/backup_file.hpp"
#include "report/value.hpp"

namespace servoctl::commands {

/// One side of a comparison: what it is called, and the bytes of its settings.
struct Side {
  std::string title;
  std::uint8_t node = 1;
  std::map<ObjectAddress, Bytes> values;
};

/// The values of a backup; what it left out is not compared.
Side side_of(const Backup& backup, std::string title);

/// The factory values the family's data knows, for this node.
Side factory_side(const drive::Profile& profile, std::uint8_t node);

/// `{compared, different, differences[{index sub id name a{…} b{…}}]}`. An entry that one side lacks counts
/// as different only where `whole` asks for it. `profile` may be null.
struct Comparison {
  report::Record record;
  std::size_t compared = 0;
  std::size_t different = 0;
};
Comparison compare(const drive::Profile* profile, const Side& a, const Side& b, bool whole, bool chinese);

/// The exit code 1 of a comparison that found differences.
Error differences_error(const Comparison& comparison, const Side& a, const Side& b);

}  // namespace servoctl::commands
