#include "report/chinese_value.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <unordered_map>
#include <utility>

#include "report/catalogue.hpp"

namespace servoctl::report {
namespace {

/// Of one result: a column says the same words again and again.
class ChineseValue {
 public:
  Value of(Value value) {
    if (auto* text = std::get_if<std::string>(&value.data())) return word(std::move(*text));
    if (const auto* truth = std::get_if<bool>(&value.data())) return word(*truth ? "yes" : "no");
    if (auto* list = std::get_if<List>(&value.data()))
      for (auto& element : *list) element = of(std::move(element));
    if (auto* record = std::get_if<Record>(&value.data())) put(*record);
    if (auto* table = std::get_if<Table>(&value.data())) put(*table);
    if (auto* plot = std::get_if<Plot>(&value.data()))
      for (auto& series : plot->series) series.name = word(series.name);
    return value;
  }

 private:
  std::string word(std::string text) {
    const auto known = known_.find(text);
    if (known != known_.end()) return known->second;
    auto out = in_chinese(text);
    known_.emplace(std::move(text), out);
    return out;
  }

  void put(Record& record) {
    for (auto& field : record) {
      if (field.show == Show::json) continue;
      if (!is_own_word(field.key)) field.value = of(std::move(field.value));
      field.title = word(field.title.empty() ? field.key : field.title);
    }
  }

  void put(Table& table) {
    if (table.json_only) return;
    for (auto& row : table.rows)
      for (std::size_t i = 0; i < std::min(row.size(), table.columns.size()); ++i)
        if (table.columns[i].show != Show::json && !is_own_word(table.columns[i].key))
          row[i] = of(std::move(row[i]));
    for (auto& column : table.columns) column.title = word(column.title.empty() ? column.key : column.title);
    for (auto& line : table.below) line = word(std::move(line));
  }

  std::unordered_map<std::string, std::string> known_;
};

}  // namespace

Value chinese_value(Value value) { return ChineseValue().of(std::move(value)); }

bool is_own_word(std::string_view key) {
  static constexpr std::array<std::string_view, 12> kOwn{
      "device_name", "hardware_version", "software_version", "panel", "object",   "time",
      "tool",        "customer",         "machine",          "bus",   "operator", "axis"};
  return std::find(kOwn.begin(), kOwn.end(), key) != kOwn.end();
}

}  // namespace servoctl::report
