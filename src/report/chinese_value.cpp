#include "report/chinese_value.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <unordered_map>
#include <utility>

#include "report/catalogue.hpp"
#include "report/chinese_marks.hpp"
#include "report/line.hpp"

namespace servoctl::report {
namespace {

/// Of one result: a column says the same words again and again.
class ChineseValue {
 public:
  explicit ChineseValue(const Names* names) : names_(names) {}

  Value of(Value value) {
    if (auto* text = std::get_if<std::string>(&value.data())) return word(std::move(*text));
    if (const auto* truth = std::get_if<bool>(&value.data())) return word(*truth ? "yes" : "no");
    if (auto* list = std::get_if<List>(&value.data()))
      for (auto& element : *list) element = of(std::move(element));
    if (auto* record = std::get_if<Record>(&value.data())) put(*record);
    if (auto* table = value.table()) put(*table);
    if (auto* plot = value.plot())
      for (auto& series : plot->series) series.name = word(series.name);
    return value;
  }

 private:
  /// Of a field or a cell: the words of a list stand in one line, with marks between them.
  Value cell(Value value) {
    value = of(std::move(value));
    const auto* list = std::get_if<List>(&value.data());
    const bool words = list != nullptr && !list->empty() &&
                       std::all_of(list->begin(), list->end(), [](const Value& element) {
                         return std::holds_alternative<std::string>(element.data());
                       });
    return words ? Value(chinese_marks(line_text(value))) : value;
  }

  std::string word(std::string text) {
    const auto known = known_.find(text);
    if (known != known_.end()) return known->second;
    auto out = in_chinese(text, names_);
    known_.emplace(std::move(text), out);
    return out;
  }

  void put(Record& record) {
    for (auto& field : record) {
      if (field.show == Show::json) continue;
      if (!is_own_word(field.key) && !is_own_word(field.title)) field.value = cell(std::move(field.value));
      field.title = word(field.title.empty() ? field.key : field.title);
    }
  }

  /// The words of a drive, and behind them how many bytes there are where they are cut short.
  Value sent(Value value) {
    auto* text = std::get_if<std::string>(&value.data());
    const auto cut = text == nullptr || !text->ends_with(')') ? std::string::npos : text->rfind("… (");
    return cut == std::string::npos ? value : Value(text->substr(0, cut) + word(text->substr(cut)));
  }

  /// What a drive sent as a string are its own words.
  static bool is_string(const Table& table, const List& row) {
    for (std::size_t i = 0; i < std::min(row.size(), table.columns.size()); ++i)
      if (const auto* type = std::get_if<std::string>(&row[i].data());
          type != nullptr && table.columns[i].key == "type")
        return *type == "string";
    return false;
  }

  void put(Table& table) {
    if (table.json_only) return;
    for (auto& row : table.rows)
      for (std::size_t i = 0; i < std::min(row.size(), table.columns.size()); ++i)
        if (const auto& column = table.columns[i]; column.show != Show::json && !is_own_word(column.key) &&
                                                   !is_own_word(column.title) &&
                                                   !(column.key == "text" && is_string(table, row)))
          row[i] = cell(std::move(row[i]));
    for (auto& column : table.columns) column.title = word(column.title.empty() ? column.key : column.title);
    if (table.below_told) return;
    for (auto& line : table.below) line = word(std::move(line));
  }

  const Names* names_;
  std::unordered_map<std::string, std::string> known_;
};

}  // namespace

Value chinese_value(Value value, const Names* names) { return ChineseValue(names).of(std::move(value)); }

bool is_own_word(std::string_view key) {
  static constexpr std::array<std::string_view, 16> kOwn{"device_name",
                                                         "hardware_version",
                                                         "software_version",
                                                         "panel",
                                                         "object",
                                                         "time",
                                                         "tool",
                                                         "customer",
                                                         "machine",
                                                         "bus",
                                                         "operator",
                                                         "axis",
                                                         "file",
                                                         "command",
                                                         "what is run",
                                                         "not in the manual"};
  return std::find(kOwn.begin(), kOwn.end(), key) != kOwn.end();
}

}  // namespace servoctl::report
