#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "commands/command.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "report/value.hpp"

/// The records that scripts rely on (docs/json.md), built in one place.
namespace servoctl::commands {

/// An error as it stands in JSON.
report::Value error_record(const Error& error);

/// A value of the dictionary as a number, text, or bytes in hexadecimal; null when there is none.
report::Value od_value(const std::optional<od::Value>& value);

/// `{"0":"Position mode"}` in JSON, `0 Position mode, 1 …` in text; null without labels.
report::Value labels_record(std::span<const od::EnumLabel> labels, bool chinese);

/// One panel parameter.
report::Record parameter_record(const od::Parameter& parameter, bool chinese);

/// Panel parameters as a table: what fits a line in text, everything in JSON.
report::Table parameter_table(std::span<const od::Parameter* const> parameters, bool chinese);

/// What was read from, or is to be written to, one object of one node.
struct Reading {
  std::uint8_t node = 0;
  drive::Target target;
  std::optional<od::DataType> type;  ///< Overrides the dictionary's type.
  Result<Bytes> bytes = Bytes{};
};

/// The value of an object, taken apart for a reader and for JSON.
struct DecodedValue {
  report::Value value;     ///< In its unit.
  report::Value raw;       ///< The number as it is sent; null when the bytes do not fit the type.
  report::Value label;     ///< Of an enum, or null.
  report::Value label_zh;  ///< In Chinese, or null.
  std::string unit;
  std::string text;  ///< What a person reads: number and unit; the beginning of a long value.
  std::string type;
};
DecodedValue decode_value(const Reading& reading, ByteSpan bytes);

/// Readings as a table, an `error` in the rows that failed. Errors are added to `context.errors`.
report::Table reading_table(Context& context, std::span<const Reading> readings);

/// Bytes of the object by its type; 0 when the type is not known or of no fixed size.
std::size_t size_of(const Reading& reading);

/// The type used to decode `bytes`: the given one, else the dictionary's, else one that fits the length.
od::DataType type_of(const Reading& reading, ByteSpan bytes);

/// Adds node and object to an error that has none.
Error located(Error error, std::uint8_t node, ObjectAddress object);

/// Whether `text` contains `word`, ASCII case ignored.
bool contains_nocase(std::string_view text, std::string_view word);

/// Whether `text` fits `pattern`, in which `*` stands for anything; ASCII case ignored.
bool fits(std::string_view pattern, std::string_view text);

}  // namespace servoctl::commands
