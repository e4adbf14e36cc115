#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/csv.hpp"
#include "drive/foreign_table.hpp"

namespace servoctl::drive {

/// A column of a family's table, and the headings people give it, as folded_heading() writes them.
struct Heading {
  std::string_view column;
  std::span<const std::string_view> exact;  ///< They mean this column alone.
  std::span<const std::string_view> loose;  ///< They mean it where no other heading does.
  bool number = false;                      ///< Its cells are numbers: brackets could change their meaning.
  std::span<const std::string_view> marks = {};  ///< A loose heading with one of them is exact: `603fh`.
};

/// Those of a table of parameters.
std::span<const Heading> parameter_headings();

/// `Default Value` and `default_value` are `defaultvalue`; text in brackets is left out.
std::string folded_heading(std::string_view text);

/// A table of somebody's, its columns known by name.
class ForeignTable {
 public:
  /// Errors: none of the headings is known; two mean one column; a number base or a remark in brackets over
  /// numbers; a filled cell without heading; no row; what read_csv() finds.
  ForeignTable(std::string_view bytes, std::string_view file, std::span<const Heading> headings,
               std::vector<Error>& errors);

  const std::vector<CsvTable::Row>& rows() const { return table_.rows; }
  bool has(std::string_view column) const { return place(column).has_value(); }
  /// As the table has it; empty where it has no such column.
  std::string heading(std::string_view column) const;
  /// The cell, without blanks around it and line breaks in it; empty for a dash, `N/A` or `无`, and where the
  /// table has no such column.
  std::string cell(const CsvTable::Row& row, std::string_view column) const;
  /// How many cells of the row say anything.
  static std::size_t filled(const CsvTable::Row& row);
  /// Whether the first cell alone says something: the title of a section.
  static bool is_title(const CsvTable::Row& row);
  /// Whether the column has 1, 2, 3 and so on.
  bool counts_rows(std::string_view column) const;
  /// The errors from this place on, in the order of their lines; and a notice for each heading that means
  /// nothing here.
  void finish(std::string_view file, std::size_t first_error, std::vector<Error>& errors,
              ConvertedTable& out) const;
  std::uint32_t heading_line() const { return heading_line_; }

 private:
  std::optional<std::size_t> place(std::string_view column) const;
  void name_columns(std::span<const Heading> headings, std::string_view file, std::vector<Error>& errors);
  void check_headings(std::span<const Heading> headings, std::string_view file,
                      std::vector<Error>& errors) const;
  void check_rows(std::string_view file, std::vector<Error>& errors);

  CsvTable table_;
  std::vector<std::string_view> names_;  ///< Of each column; empty: none.
  std::vector<std::string> unknown_;
  std::uint32_t heading_line_ = 1;
};

}  // namespace servoctl::drive
