#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "report/value.hpp"

/// Parts of a result, by the names they have in JSON.
namespace servoctl::cli {

/// `[3]` or `.name`.
struct PathStep {
  std::optional<std::size_t> element;
  std::string field;
};

/// Reads `.`, `[0].value`, `.fault.code`. Errc::usage for anything else.
Result<std::vector<PathStep>> parse_path(std::string_view path);

/// A part of a result and where it was found.
struct Part {
  std::string where;
  report::Value value;
};

/// What the path leads to: several parts where a field of each element of a list is asked for. Errc::negative
/// when there is no such part; the fields there are stand in the hint.
Result<std::vector<Part>> follow(const report::Value& result, std::string_view path);

/// The elements of a list or table; empty when it is neither.
std::optional<std::vector<report::Value>> elements(const report::Value& value);

std::optional<long double> number(const report::Value& value);

/// A text as it is, everything else as in JSON.
std::string text(const report::Value& value);

}  // namespace servoctl::cli
