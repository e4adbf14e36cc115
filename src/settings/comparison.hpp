#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "report/value.hpp"
#include "settings/backup_file.hpp"

namespace servoctl::settings {

/// One side of a comparison: what it is called, and the bytes of its settings.
struct Side {
  std::string title;
  std::uint8_t node = 1;
  std::map<ObjectAddress, Bytes> values;
  bool is_drive = false;                    ///< The title is that of its node.
  const drive::Profile* profile = nullptr;  ///< What describes it, where that is not what describes both.
};

/// A value as people read it, with its unit or label; `-` where the side has none.
std::string value_text(const drive::Profile* profile, const Side& side, ObjectAddress object, bool chinese);

/// The values of a backup; what it left out is not compared.
Side side_of(const Backup& backup, std::string title);

/// A title in a message: `factory` is a word of the program, `node 3` is the node, everything else a name.
Message title_in_message(std::string_view title);
Message title_in_message(const Side& side);

/// The factory values the family's data knows, for this node.
Side factory_side(const drive::Profile& profile, std::uint8_t node);

/// Takes away what the network of the desk does not reach (Modbus: what has no register), and says how many.
/// `profile` may be null.
void leave_unreachable(show::Desk& desk, const drive::Profile* profile, Side& side);

/// Whether it is the node-ID or the bitrate, by the family's rules. `profile` may be null.
bool is_address(const drive::Profile* profile, ObjectAddress object);
/// Whether a drive that is enabled follows it at once, by the family's rules of Modbus.
bool is_target(const drive::Profile& profile, ObjectAddress object);
/// Whether it is address, speed or framing of Modbus.
bool is_line_address(const drive::Profile& profile, ObjectAddress object);

/// Bytes read from node `from` as node `to` would hold them: a COB-ID that contains the node-ID, and the
/// parameter of the node-ID itself, follow the node. `profile` may be null.
Bytes for_node(const drive::Profile* profile, ObjectAddress object, const Bytes& bytes, std::uint8_t from,
               std::uint8_t to);

/// `{compared, different, differences[{index sub id name a{…} b{…}}]}`. An entry that one side lacks counts
/// as different only where `whole` asks for it. Each side's values are compared as its own node's. `profile`
/// describes both sides where a side has none of its own; it may be null.
struct Comparison {
  report::Record record;
  std::size_t compared = 0;
  std::size_t different = 0;
};
Comparison compare(const drive::Profile* profile, const Side& a, const Side& b, bool whole, bool chinese);

/// The command lines that give the drive of `a` the values of `b`, PDOs by procedure: what compare() finds
/// different. Node-ID and bitrate are comments, as what only `a` has.
std::vector<std::string> lines_between(const drive::Profile* profile, const Side& a, const Side& b,
                                       bool whole);

/// The COB-IDs of PDOs of which a side has a value and not this one; such as the family has.
std::vector<ObjectAddress> cob_ids_lacking(const drive::Profile& profile, const Side& side);

/// The exit code 1 of a comparison that found differences.
Error differences_error(const Comparison& comparison, const Side& a, const Side& b);

}  // namespace servoctl::settings
