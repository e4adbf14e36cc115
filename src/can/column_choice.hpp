#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/log_columns.hpp"

namespace servoctl::can {

/// What a user says of the columns: in their order, `time,-,id,data`, each perhaps with how it is written
/// (`time:ms`, `id:dec`, `data:hex`), or each with its name in the header line, `id=CAN ID,data=Payload`.
class ColumnChoice {
 public:
  /// Errc::usage for words that are no columns, for one without an identifier or without data.
  static Result<ColumnChoice> parse(std::string_view text);

  /// The columns by the header line `line`, if they are named by one; empty where it has not all of them.
  std::optional<LogColumns> by_header(std::string_view line) const;
  bool by_names() const { return !names_.empty(); }
  /// The columns in their order; `separator` as the lines have it.
  LogColumns in_order(char separator) const;
  std::size_t count() const { return columns_.roles.size(); }

 private:
  LogColumns columns_;
  std::vector<std::string> names_;  ///< In a header line, for each role; empty: in their order.
};

}  // namespace servoctl::can
