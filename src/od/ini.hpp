#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace servoctl::od {

/// A `key=value` line.
struct IniKey {
  std::string_view key;
  std::string_view value;
  std::uint32_t line = 0;          ///< From 1.
  std::uint32_t value_column = 0;  ///< From 1, in bytes.
};

struct IniSection {
  std::string_view name;
  std::uint32_t line = 0;
  std::vector<IniKey> keys;

  /// The last key of this name, ASCII case ignored; null when there is none.
  const IniKey* find(std::string_view key) const;
};

/// A line that is neither blank, comment, section nor key.
struct IniStray {
  std::uint32_t line = 0;
  std::string_view text;
};

/// A text in sections, as EDS files are written (CiA 306-1, 4): `[section]`, `key=value`, `;` comments. Lines
/// end with LF, CRLF or CR; a byte order mark is skipped. All views point into the text. Linear in its
/// length.
struct IniText {
  std::vector<IniSection> sections;  ///< In the order of the file; a name may stand several times.
  std::vector<IniStray> strays;
  std::unordered_map<std::string, std::size_t> by_name;  ///< Lower-case name to its first section.

  const IniSection* find(std::string_view name) const;
};

IniText parse_ini(std::string_view text);

}  // namespace servoctl::od
