#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "od/data_type.hpp"

namespace servoctl::settings {

/// A value in the words of a command line: `Pn0202=2`, `0x6065:0 1000 --type u32`.
struct NamedValue {
  std::string name;
  std::string value;
  bool panel = false;  ///< `name` is a number of the panel; else any name of an object.
  std::optional<od::DataType> type = {};
};

/// A command line that is read as settings, and not run.
struct SettingLine {
  std::uint32_t line = 0;           ///< Of the file, from 1.
  std::vector<std::uint8_t> nodes;  ///< That the file names for this line; empty: it does not say.
  std::string family;               ///< The same.
  /// What it writes; none where it only prepares. An error where it is no line that writes values.
  Result<std::vector<NamedValue>> values;
};

/// Of a command line, named by its command, that is none of `param set` and `write`.
tl::unexpected<Error> writes_no_value(std::string_view command);

/// Who understands command lines.
class LineReader {
 public:
  LineReader() = default;
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;
  virtual ~LineReader() = default;

  /// Takes a batch file apart into its command lines, loops unrolled. Errc::file with the line of the first
  /// that is wrong, or is no command.
  virtual Result<std::vector<SettingLine>> setting_lines(std::string_view text, const std::string& file) = 0;
};

}  // namespace servoctl::settings
