#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace servoctl::od {

/// A `key=value` line.
struct IniKey {
  std::string_view key;
  std::string_view value;
  std::uint32_t line = 0;          ///< From 1.
  std::uint32_t value_column = 0;  ///< From 1, in bytes.
};

/// A line that is neither blank, comment, section nor key.
struct IniStray {
  std::uint32_t line = 0;
  std::string_view text;
};

/// A section of an IniText, which must outlive it.
struct IniSection {
  std::string_view name;
  std::uint32_t line = 0;
  bool closed = true;  ///< Whether the `]` is there.
  std::span<const IniKey> keys;

  /// The last key of this name, ASCII case ignored; null when there is none.
  const IniKey* find(std::string_view key) const;
};

/// A text in sections, as EDS files are written (CiA 306-1, 4): `[section]`, `key=value`, `;` comments. Lines
/// end with LF, CRLF or CR. All views point into the text. Time and memory are linear in its length.
struct IniText {
  std::vector<IniSection> sections;  ///< In the order of the file; a name may stand several times.
  std::vector<IniKey> keys;          ///< Of all sections, in the order of the file.
  std::vector<IniStray> strays;
};

IniText parse_ini(std::string_view text);

}  // namespace servoctl::od
