#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "od/dictionary.hpp"

namespace servoctl::od {

/// One panel parameter: a line of `<family>.params.csv` (docs/drive-data.md). Default and limits are raw
/// numbers, as the panel shows them.
struct Parameter {
  std::string id;                       ///< As the manual writes it: `Pn0202`.
  std::optional<ObjectAddress> object;  ///< Empty: it can be changed on the panel only.
  DataType type = DataType::u16;
  Access access = Access::rw;
  std::string unit;  ///< After scaling; empty if none.
  double scale = 1;  ///< Value in `unit` = raw × scale.
  Encoding encoding = Encoding::plain;
  std::optional<Value> default_value;
  std::optional<Value> min;
  std::optional<Value> max;
  Effect effect = Effect::unstated;
  std::vector<EnumLabel> labels;
  std::string name;
  std::string name_zh;
  std::string group;
  bool command = false;                 ///< Writing it starts an action; kept out of backups.
  bool is_volatile = false;             ///< A reading, not a setting; kept out of backups.
  bool placed = false;                  ///< It has no number of its own: `id` is the address of its object.
  std::optional<ObjectAddress> mirror;  ///< The object whose stored value it is.
  Doubts doubts;
  std::string note;
  std::string note_zh;
  std::uint32_t line = 0;       ///< Line of the manual.
  std::uint32_t file_line = 0;  ///< Line of the table.
};

/// Reads a table of panel parameters. Errc::file with file and line for an unknown column, a bad cell, a
/// value that does not fit its type, min above max, a default outside its limits, an id or object that
/// appears twice, an unknown flag: the first of them.
Result<std::vector<Parameter>> parse_parameters(std::string_view csv, std::string_view file);

/// The same of all rows that are right; adds everything that is wrong to `errors`.
std::vector<Parameter> read_parameters(std::string_view csv, std::string_view file,
                                       std::vector<Error>& errors);

/// Merges `<family>.objects.csv` into the dictionary: unit, scale, effect, labels, Chinese name, PDO
/// direction, flags; a line without a sub-index has the Chinese name of an object of several entries.
/// Adds Errc::file with file and line for each bad cell and each object the dictionary does not have.
void annotate(Dictionary& dictionary, std::string_view csv, std::string_view file,
              std::vector<Error>& errors);
/// The same; the first of these errors.
Result<void> annotate(Dictionary& dictionary, std::string_view csv, std::string_view file);

}  // namespace servoctl::od
