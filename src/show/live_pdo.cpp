#include "show/live_pdo.hpp"

#include "base/format.hpp"
#include "show/records.hpp"

namespace servoctl::show {

LiveView::Layout pdo_layout() {
  return {.columns = {
              {.title = "node", .right = true}, {.title = "PDO"}, {.title = "object"}, {.title = "value"}}};
}

void show_values(LiveView& live, const PdoView& view, ByteSpan data, bool chinese) {
  const auto node = formatted("{}", view.node);
  const auto row = formatted("{} {}", node, view.name);
  std::string text;
  if (!shows_values(view, data)) {
    append_values(view, data, chinese, text);
    return live.set(row, {node, view.name, "", std::move(text)});
  }
  for (const auto& field : view.fields) {
    const auto value = field.value(data);
    text.clear();
    append_value(field, value, chinese, text);
    live.set(formatted("{} {}", row, field.first_bit), {node, view.name, field.name, text},
             field.meaning.bits ? std::nullopt : plotted(od_value(value)));
  }
}

}  // namespace servoctl::show
