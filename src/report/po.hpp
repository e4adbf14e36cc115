#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace servoctl::report {

/// One message of a catalogue in the form of GNU gettext.
struct PoEntry {
  std::string id;    ///< As it stands in the source: an fmt format string, or plain text.
  std::string text;  ///< The same in the other language; empty where nobody has translated it.
  std::vector<std::string> remarks = {};  ///< Of `#.` lines.
  std::size_t line = 0;                   ///< Of its msgid, from 1.
};

/// Reads `msgid` and `msgstr` with their continuation lines. The escapes are those of C: `\n \t \r \" \\`.
/// Errc::file with the line for anything else, for a msgid that appears twice and one without msgstr; `file`
/// is used in messages. The header, whose msgid is empty, is left out.
Result<std::vector<PoEntry>> parse_po(std::string_view text, std::string_view file);

}  // namespace servoctl::report
