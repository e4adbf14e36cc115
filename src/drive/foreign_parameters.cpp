// A table of parameters as people have it, made into one of a family.
#include <algorithm>
#include <unordered_map>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "drive/foreign_cells.hpp"
#include "drive/foreign_heading.hpp"
#include "drive/foreign_row.hpp"
#include "drive/foreign_table.hpp"
#include "drive/foreign_words.hpp"
#include "drive/maker_parameters.hpp"
#include "drive/parameter_ids.hpp"
#include "od/parameter.hpp"

namespace servoctl::drive {
namespace {

class ParameterConversion {
 public:
  ParameterConversion(const ForeignTable& table, std::string_view file, const od::Dictionary& dictionary,
                      std::vector<Error>& errors)
      : table_(&table), file_(file), dictionary_(&dictionary), errors_(&errors) {
    for (const auto& one : maker_parameters(dictionary))
      if (!one.placed && one.object) makers_.emplace(canonical_id(one.id), *one.object);
  }

  ConvertedTable run() {
    for (const auto& row : table_->rows()) take(row);
    if (!settle_numbers(rows_, file_, *errors_, out_.notices)) return std::move(out_);
    for (auto& row : rows_) add_from_sheet(row, file_, *errors_, out_.notices);
    note_unreachable();
    check();
    out_.rows = rows_.size();
    out_.csv = std::string(kForeignRowHeader) + "\n";
    for (const auto& row : rows_) out_.csv += row.csv();
    return std::move(out_);
  }

 private:
  void wrong(std::uint32_t line, const Message& what, Message hint) {
    errors_->push_back(file_error(file_, line, what, std::move(hint)));
  }

  void take(const CsvTable::Row& cells) {
    const auto cell = [&](std::string_view column) { return table_->cell(cells, column); };
    if (ForeignTable::filled(cells) == 0) return;
    if (ForeignTable::is_title(cells)) {
      out_.notices.push_back(
          message("{}:{}: left out: a line with its first cell alone", as_it_is(file_), cells.line));
      return;
    }
    ForeignRow row;
    row.line = cells.line;
    row.id = cell("id");
    if (row.id.empty() && cell("object").empty())
      return wrong(row.line, "a row without a parameter number",
                   "write the number in each row, in one cell all that belongs to it; or remove the row");
    if (is_changed_by_spreadsheet(row.id))
      return wrong(
          row.line,
          message("'{}' is a date or a rounded number, perhaps made of a parameter number by a spreadsheet",
                  as_it_is(row.id)),
          "format the column as text before the table is pasted, and write the number as the manual does");
    object(row, cell("object"), cell("sub"));
    if (row.id.empty()) row.id = row.object;
    row.type = family_type(cell("type"));
    row.access = family_access(cell("access"));
    units(row, cell("unit"), cell("scale"));
    labels(row, cell);
    values(row, cell);
    row.effect = family_effect(cell("effect"));
    names(row, cell);
    row.group = lower(cell("group"));
    rows_.push_back(std::move(row));
  }

  /// By its object, else by the number that the data sheet has in the names.
  void object(ForeignRow& row, const std::string& index, const std::string& sub) {
    if (index.empty() && !sub.empty())
      return wrong(row.line, message("sub-index {} without an index", as_it_is(sub)),
                   "write the index in each row");
    if (index.empty()) {
      const auto known = makers_.find(canonical_id(row.id));
      if (known == makers_.end()) return;
      row.object = formatted("0x{:04X}:{:02X}", known->second.index, known->second.sub);
      row.entry = dictionary_->find(known->second);
      return;
    }
    const auto named = family_object(index, sub);
    row.object = named.text;
    if (!named.address) return;  // The reader says so.
    if (!named.doubtful.empty())
      return wrong(row.line,
                   message("sub-index '{}' may be decimal or hexadecimal", as_it_is(named.doubtful)),
                   message("write 0x{} or 0x{:02X}", as_it_is(named.doubtful),
                           parse_digits(named.doubtful, 10).value_or(0)));
    const auto* whole = dictionary_->object(named.address->index);
    const bool parts =
        whole != nullptr && (whole->entries.size() > 1 || whole->code == od::ObjectCode::array ||
                             whole->code == od::ObjectCode::record);
    if (parts && !named.has_sub)
      return wrong(row.line,
                   message("object 0x{:04X} has several entries, and no sub-index is given", whole->index),
                   "write the sub-index");
    row.entry = dictionary_->find(*named.address);
  }

  void units(ForeignRow& row, const std::string& unit, const std::string& scale) {
    const auto known = family_unit(unit);
    if (!known)
      return wrong(
          row.line, message("the unit '{}' is not understood", as_it_is(unit)),
          "write a factor with a point, and the unit: 0.1 Hz; or the factor in a column 'scale' (value = "
          "raw × scale)");
    row.unit = known->second;
    row.scale = scale.empty() ? known->first : scale;
    if (parse_real(row.scale) == 1.0) row.scale.clear();
    if (!scale.empty() && !known->first.empty() && parse_real(scale) != parse_real(known->first))
      wrong(row.line, message("the scale is {}, but the unit is '{}'", as_it_is(scale), as_it_is(unit)),
            "write the factor once");
  }

  template <class Cell>
  void labels(ForeignRow& row, const Cell& cell) {
    const auto take = [&](std::string& own, const std::string& text) {
      if (const auto list = family_labels(text))
        own = *list;
      else
        wrong(row.line, message("the list '{}' is not understood", as_it_is(text)), "write it as 0=off;1=on");
    };
    take(row.labels, cell("enum"));
    take(row.labels_zh, cell("enum_zh"));
    if (row.labels.empty()) row.labels = row.labels_zh;
  }

  /// A number with a comma: what it is, nothing says. Its cells are no further looked at.
  template <class Cell>
  bool has_comma(const ForeignRow& row, const Cell& cell) {
    for (const std::string_view column : {"default", "min", "max", "range"}) {
      const auto text = cell(column);
      if (!has_decimal_comma(text) || family_range(text) || family_labels(text)) continue;
      wrong(row.line,
            message("'{}' in column '{}': a comma between digits is not read", as_it_is(text),
                    as_it_is(table_->heading(column))),
            "write decimals with a point and nothing between thousands: 0.5, 1000");
      return true;
    }
    return false;
  }

  template <class Cell>
  void values(ForeignRow& row, const Cell& cell) {
    if (has_comma(row, cell)) return;
    row.standard = cell("default");
    row.low = cell("min");
    row.high = cell("max");
    const auto range = cell("range");
    if (range.empty()) return;
    const auto take = [&](std::string& own, const std::string& of_range, std::string_view what) {
      if (!own.empty() && own != of_range)
        wrong(row.line,
              message("{} is {}, but the range is '{}'", as_it_is(what), as_it_is(own), as_it_is(range)),
              "write the limits once");
      own = of_range;
    };
    if (const auto both = family_range(range)) {
      take(row.low, both->first, "min");
      take(row.high, both->second, "max");
    } else if (const auto list = family_labels(range)) {
      if (!row.labels.empty() && row.labels != *list)
        wrong(row.line, message("the range '{}' is another list than the labels", as_it_is(range)),
              "write the list once");
      row.labels = *list;
    } else {
      wrong(row.line, message("the range '{}' is not understood", as_it_is(range)),
            "write it as 0~1000, or as a list 0=off;1=on");
    }
  }

  template <class Cell>
  static void names(ForeignRow& row, const Cell& cell) {
    row.name = cell("name");
    row.name_zh = cell("name_zh");
    row.note = cell("note");
    row.note_zh = cell("note_zh");
    if (row.name_zh.empty() && has_chinese(row.name)) row.name_zh = row.name;
    if (row.note_zh.empty() && has_chinese(row.note)) row.note_zh = row.note;
    if (row.labels_zh.empty() && has_chinese(row.labels)) row.labels_zh = row.labels;
    if (has_chinese(row.name) && row.entry != nullptr && !row.entry->name.empty()) {
      const auto split = split_number(row.entry->name);
      row.name = split ? split->name : row.entry->name;
    }
    if (row.name.empty()) row.name = !row.name_zh.empty() ? row.name_zh : row.id;
  }

  /// The bus does not reach them, or the table has no column with their objects.
  void note_unreachable() {
    std::size_t count = 0;
    std::uint32_t line = 0;
    for (const auto& row : rows_) {
      if (!row.object.empty()) continue;
      if (count++ == 0) line = row.line;
    }
    if (count > 0)
      out_.notices.push_back(message(
          "{}:{}: parameters without an object, which the bus does not reach: {}, the first in this line",
          as_it_is(file_), line, count));
  }

  /// The rows as the family's reader takes them, in their own lines.
  void check() {
    std::string text = std::string(kForeignRowHeader) + "\n";
    std::uint32_t line = 2;
    for (const auto& row : rows_) {
      for (; line < row.line; ++line) text += '\n';
      text += row.csv();
      ++line;
    }
    const auto parameters = od::read_parameters(text, file_, *errors_);
    refuse_same_ids(parameters, file_, *errors_);
    for (auto& error : shadowing_ids(parameters, *dictionary_, file_)) errors_->push_back(std::move(error));
    for (const auto& row : rows_)
      if (const auto object = parse_object_address(row.object);
          object && dictionary_->find(*object) == nullptr)
        wrong(row.line,
              message("{}: object {} is not in the data sheet", as_it_is(row.id), as_it_is(row.object)),
              "correct the object, or leave it empty if the bus does not reach the parameter");
  }

  const ForeignTable* table_;
  std::string_view file_;
  const od::Dictionary* dictionary_;
  std::vector<Error>* errors_;
  std::unordered_map<std::string, ObjectAddress> makers_;  ///< Of the numbers in the names of objects.
  std::vector<ForeignRow> rows_;
  ConvertedTable out_;
};

/// Columns that cannot be what the table of a family needs.
void check_columns(const ForeignTable& table, std::string_view file, std::vector<Error>& errors) {
  const auto wrong = [&](const Message& what, Message hint) {
    errors.push_back(file_error(file, table.heading_line(), what, std::move(hint)));
  };
  if (!table.has("id") && !table.has("object"))
    wrong("no column has the parameter numbers", "name it id or No.");
  if (table.has("factor"))
    wrong(message("'{}' does not say whether raw numbers are multiplied or divided",
                  as_it_is(table.heading("factor"))),
          "name the column 'scale' and write numbers for which value = raw × scale");
  // A user who calls it `id` means it.
  if (folded_heading(table.heading("id")) != "id" && table.counts_rows("id"))
    wrong(
        message("the column '{}' counts the rows: 1, 2, 3", as_it_is(table.heading("id"))),
        "remove it and name the column with the parameter numbers 'id'; name it 'id' itself if these are the "
        "numbers");
}

}  // namespace

ConvertedTable convert_parameters(std::string_view bytes, std::string_view file,
                                  const od::Dictionary& dictionary, std::vector<Error>& errors) {
  const auto before = errors.size();
  const ForeignTable table(bytes, file, parameter_headings(), errors);
  if (errors.size() != before) return {};
  check_columns(table, file, errors);
  if (errors.size() != before) return {};
  auto out = ParameterConversion(table, file, dictionary, errors).run();
  table.finish(file, before, errors, out);
  return out;
}

}  // namespace servoctl::drive
