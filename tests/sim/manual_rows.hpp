#pragma once

#include <ios>
#include <optional>
#include <string>
#include <vector>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/number.hpp"
#include "sim_support.hpp"
#include "tests/source_dir.hpp"

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
  const std::string path = source_dir() + "/tests/vectors/" + family + "-states.csv";
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

inline constexpr unsigned kLimit = 1U << 11U;

inline constexpr ObjectAddress kControlword{0x6040, 0};
inline constexpr ObjectAddress kMode{0x6060, 0};
inline constexpr ObjectAddress kTarget{0x607A, 0};
inline constexpr ObjectAddress kLower{0x607D, 1};
inline constexpr ObjectAddress kUpper{0x607D, 2};
inline constexpr ObjectAddress kPosition{0x6064, 0};
inline constexpr ObjectAddress kVelocity{0x60FF, 0};
inline constexpr ObjectAddress kPoint{0x60C1, 1};

/// A drive whose rows of a manual are looked for.
class RowTest : public DrivenTest {
 protected:
  /// The row of the manual comes; `of` are the bits that are looked at where the row prints more.
  void expect_row(const std::string& mode, unsigned line, const std::string& step, unsigned of = 0xFFFF) {
    for (const auto& row : manual_rows(family_, mode, line, line))
      if (row.step == step) {
        EXPECT_TRUE(reaches(row.statusword, row.mask & of))
            << mode << " line " << line << ": " << std::hex << status() << " for " << row.statusword;
        return;
      }
    ADD_FAILURE() << "the manual has no row " << mode << " " << line << " " << step;
  }
  void control(std::string_view word) { write(kControlword, word); }
  void stop_at(std::string_view lower, std::string_view upper) {
    write(kLower, lower);
    write(kUpper, upper);
  }
};

/// A drive of which nothing more is known than CiA 402, with ramps that take little time.
class StandardTest : public RowTest {
 protected:
  void SetUp() override {
    boot("cia402");
    write({0x6081, 0}, "10000");
    write({0x6083, 0}, "100000");
  }
  void go(std::string_view target) {
    write(kTarget, target);
    control("15");
    control("31");
  }
};

}  // namespace servoctl::sim
