#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/object_address.hpp"

namespace servoctl::drive {

/// Numbers, units, ranges, lists, objects and codes in cells of tables as people write them.

/// `0.1Hz`: the scale `0.1` and the unit `Hz`; `r/min` and `min-1` are `rpm`. Empty where more is calculated:
/// `10^-3 s`, `1/100 Hz`, `0,1 Hz`.
std::optional<std::pair<std::string, std::string>> family_unit(std::string_view text);
/// `0~1000`, `-5 to 5`, `[0, 100]`, `±100`; empty for anything else.
std::optional<std::pair<std::string, std::string>> family_range(std::string_view text);
/// `0,5` or `1,000`: with a comma between digits, a number may be either.
bool has_decimal_comma(std::string_view text);
/// `2-Jan`, `1月2日`, `2026-01-02`, `2.00E+05`: what a spreadsheet makes of the numbers 1-02 and 2E05.
bool is_changed_by_spreadsheet(std::string_view text);
/// `0: off, 1: on` or `0：关 1：开` as `0=off;1=on`; empty for what is no such list, or may be another one.
std::optional<std::string> family_labels(std::string_view text);
/// An object as a table names it.
struct ForeignObject {
  std::string text;                      ///< `0x2001:01`, or the text of the cell where it is no object.
  std::optional<ObjectAddress> address;  ///< Empty: it is no object.
  bool has_sub = false;                  ///< A sub-index is given.
  std::string doubtful;                  ///< A sub-index that may be decimal or hexadecimal: `10`.
};
/// `2001h`, `0x2001`, with the sub-index of a column of its own: `0x2001:01`.
ForeignObject family_object(std::string_view index, std::string_view sub);
/// `2310h`, `0x2310`: `0x2310`, and `2310` if the column has codes of 603Fh; empty for what is no code of
/// four digits.
std::optional<std::string> family_code(std::string_view text, bool is_code);

}  // namespace servoctl::drive
