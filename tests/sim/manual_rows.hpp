#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/number.hpp"

namespace servoctl::sim {

/// One line of a table of controlwords and statuswords.
struct ManualRow {
  unsigned line = 0;
  std::string mode;
  std::string step;
  std::optional<unsigned> controlword;
  unsigned statusword = 0;
  unsigned mask = 0;
};

/// Rows of these lines and this mode that print a statusword.
inline std::vector<ManualRow> manual_rows(const std::string& family, const std::string& mode, unsigned first,
                                          unsigned last) {
  const std::string path = SERVOCTL_SOURCE_DIR "/tests/vectors/" + family + "-states.csv";
  const auto table = parse_csv(read_file(path).value(), path).value();
  std::vector<ManualRow> out;
  for (const auto& cells : table.rows) {
    const auto number = [&](const char* column) -> std::optional<unsigned> {
      const auto value = parse_integer(cells.cells[table.column(column)]);
      return value ? std::optional(static_cast<unsigned>(value->magnitude)) : std::nullopt;
    };
    const auto line = number("line").value_or(0);
    if (line < first || line > last || cells.cells[table.column("mode")] != mode) continue;
    out.push_back({line, mode, cells.cells[table.column("step")], number("controlword"),
                   number("statusword").value_or(0), number("mask").value_or(0)});
  }
  return out;
}

}  // namespace servoctl::sim
