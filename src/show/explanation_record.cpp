// An answer of `explain` in the form that scripts rely on.
#include <string>
#include <vector>

#include "show/explanation.hpp"

namespace servoctl::show {
namespace {

using report::List;
using report::Record;
using report::Value;

Value list_or_null(const std::vector<std::string>& texts) {
  if (texts.empty()) return {};
  List out;
  for (const auto& text : texts) out.emplace_back(text);
  return out;
}

Value row_records(const Explanation& explanation) {
  const auto& rows = explanation.topic.rows;
  if (rows.empty()) return {};
  auto shown = explanation.rows;
  if (shown.empty())
    for (std::size_t i = 0; i < rows.size(); ++i) shown.push_back(i);
  List out;
  for (const auto i : shown)
    out.emplace_back(Record{{"cells", list_or_null(rows[i].cells)},
                            {"text", report::text_or_null(rows[i].text)},
                            {"text_zh", report::text_or_null(rows[i].text_zh)},
                            {"line", report::text_or_null(rows[i].line)}});
  return out;
}

}  // namespace

Record explanation_record(const Explanation& explanation) {
  const auto& topic = explanation.topic;
  return {{"kind", topic.kind},
          {"family", topic.family},
          {"name", topic.name},
          {"also", list_or_null(topic.also)},
          {"title", topic.title},
          {"title_zh", report::text_or_null(topic.title_zh)},
          {"text", report::text_or_null(topic.text)},
          {"text_zh", report::text_or_null(topic.text_zh)},
          {"columns", list_or_null(topic.columns)},
          {"columns_zh", list_or_null(topic.columns_zh)},
          {"rows", row_records(explanation)},
          {"picture", report::text_or_null(topic.picture)},
          {"note", report::text_or_null(topic.note)},
          {"note_zh", report::text_or_null(topic.note_zh)},
          {"assumed", topic.assumed},
          {"figure", topic.figure},
          {"object", topic.object ? Value(to_string(*topic.object)) : Value()},
          {"value", topic.value ? Value(*topic.value) : Value()},
          {"line", report::text_or_null(topic.line)},
          {"found", name(explanation.found)},
          {"details", explanation.details}};
}

}  // namespace servoctl::show
