#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "can/log_columns.hpp"

/// How the columns of a log are called, in English, German and Chinese.
namespace servoctl::can {

/// A name in a header, without what stands in brackets.
struct HeaderName {
  std::string name;
  std::string qualifier;
};

HeaderName header_name(std::string_view cell);

/// What a column of this name holds; empty for a name that is not known.
std::optional<LogRole> role_of_name(std::string_view name);

/// Whether it is a time that counts from the line before.
bool is_delta_name(std::string_view name);

/// How a column is written, by its name or what stands in brackets behind it.
void take_qualifier(LogRole role, const HeaderName& name, LogNumbers& out);

}  // namespace servoctl::can
