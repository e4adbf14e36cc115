#include "command/one_drive.hpp"

#include <variant>

namespace servoctl::command {

using report::List;
using report::Record;
using report::Show;
using report::Value;

Value of_one_drive(Value value) {
  if (auto* table = value.table())
    for (auto& column : table->columns)
      if (column.key == "node") column.show = Show::json;
  auto* list = std::get_if<List>(&value.data());
  if (list == nullptr) return value;
  if (list->empty()) return {};
  auto first = list->front();
  if (auto* record = std::get_if<Record>(&first.data()))
    for (auto& field : *record)
      if (field.key == "node") field.show = Show::json;
  return first;
}

}  // namespace servoctl::command
