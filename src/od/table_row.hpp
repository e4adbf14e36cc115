#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/csv.hpp"
#include "base/result.hpp"
#include "od/dictionary.hpp"

namespace servoctl::od {

/// The columns of a table, found by name once; cells of a row are then taken by their place.
class TableColumns {
 public:
  /// Adds an error of Errc::file for each column of the table that is not in `known`.
  static TableColumns find(const CsvTable& table, std::span<const std::string_view> known,
                           std::string_view file, std::vector<Error>& errors);
  std::size_t place(std::size_t known_index) const { return places_[known_index]; }

 private:
  std::vector<std::size_t> places_;
};

/// Reads the cells of one row; remembers all that is wrong.
class TableRow {
 public:
  TableRow(const CsvTable::Row& row, const TableColumns& columns, std::span<const std::string_view> names,
           std::string_view file)
      : row_(&row), columns_(&columns), names_(names), file_(file) {}

  /// The cell of the column at this place in the list of names; empty when the table has no such column.
  std::string_view cell(std::size_t column) const;

  std::optional<ObjectAddress> object(std::size_t column);
  double scale(std::size_t column);
  Encoding encoding(std::size_t column);
  Effect effect(std::size_t column);
  std::optional<Value> value(std::size_t column, DataType type);
  /// The marks of two columns; a contradiction without lines of the manual is refused.
  Doubts doubts(std::size_t assumed, std::size_t contradicted);
  std::vector<EnumLabel> labels(std::size_t column, std::size_t column_zh);
  std::uint32_t number(std::size_t column);

  /// Notes that the cell is not what it should be.
  void refuse(std::size_t column, const Message& expected);
  /// Notes anything else that is wrong in the row.
  void refuse(const Message& what, Message hint = {});
  const std::vector<Error>& errors() const { return errors_; }

 private:
  const CsvTable::Row* row_;
  const TableColumns* columns_;
  std::span<const std::string_view> names_;
  std::string_view file_;
  std::vector<Error> errors_;
};

}  // namespace servoctl::od
