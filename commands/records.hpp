#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "commands/command.hpp"
#include "od/parameter.hpp"
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

/// Adds node and object to an error that has none.
Error located(Error error, std::uint8_t node, ObjectAddress object);

/// Whether `text` contains `word`, ASCII case ignored.
bool contains_nocase(std::string_view text, std::string_view word);

/// Whether `text` fits `pattern`, in which `*` stands for anything; ASCII case ignored.
bool fits(std::string_view pattern, std::string_view text);

}  // namespace servoctl::commands
