#pragma once

#include <optional>

#include "can/recording.hpp"
#include "command/command.hpp"

namespace servoctl::command {

inline constexpr Parameter kColumnsOption{
    .name = "--columns",
    .help = "columns of a table that does not name them: time:ms,-,id:dec,len,data",
    .kind = Kind::text};

/// What the user says of the columns of a recording; nothing where nothing was said.
inline Result<std::optional<can::ColumnChoice>> recording_columns(const Arguments& arguments) {
  if (!arguments.has(kColumnsOption.name)) return std::nullopt;
  auto columns = can::ColumnChoice::parse(arguments.text(kColumnsOption.name));
  if (!columns) return fail(columns.error());
  return std::optional(std::move(*columns));
}

}  // namespace servoctl::command
