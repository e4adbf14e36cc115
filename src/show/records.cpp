#include "show/records.hpp"

#include <algorithm>
#include <iterator>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::show {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::Table;
using report::Value;

std::string shown_name(std::string_view english, std::string_view chinese_name, bool chinese) {
  return std::string(chinese && !chinese_name.empty() ? chinese_name : english);
}

Value object_record(const std::optional<ObjectAddress>& object) {
  if (!object) return {};
  return Record{{"index", object->index}, {"sub", object->sub}};
}

Value abort_record(const Error& error, std::string_view words) {
  if (!error.abort_code) return {};
  return Record{{"code", formatted("0x{:08X}", *error.abort_code)},
                {"text", words.empty() ? canopen::sdo_abort_text(*error.abort_code) : std::string(words)}};
}

Value words(std::string_view text) {
  List out;
  for (const auto word : split(text, ' ')) out.emplace_back(word);
  return out;
}

std::string flags_of(const od::Parameter& p) {
  std::string out;
  const auto add = [&](std::string_view word) { append(out, std::string(word), " "); };
  if (p.command) add("command");
  if (p.is_volatile) add("volatile");
  if (p.mirror) add("mirror=" + to_string(*p.mirror));
  return out;
}

std::string unit_text(std::string_view unit, double scale) {
  if (scale == 1) return std::string(unit);
  return formatted("{}{}{}", plain_number(scale, 6), unit.empty() ? "" : " ", unit);
}

std::string range_of(const od::Parameter& p) {
  if (!p.min && !p.max) return {};
  return (p.min ? od::to_string(*p.min) : std::string()) + ".." +
         (p.max ? od::to_string(*p.max) : std::string());
}

}  // namespace

std::string abort_words(const Desk& desk, std::uint32_t code) {
  return abort_words(desk.profile, desk.chinese, code);
}

std::string abort_words(const Desk& desk, const Error& error) {
  return error.abort_code ? abort_words(desk.profile, false, *error.abort_code) : std::string();
}

std::string abort_words(const drive::Profile* profile, bool chinese, std::uint32_t code) {
  if (profile != nullptr) {
    const auto& texts = profile->rules.abort_texts;
    const auto found = texts.find(code);
    const auto words = found == texts.end()
                           ? std::string_view()
                           : std::string_view(chinese ? found->second.text_zh : found->second.text);
    if (!words.empty()) return std::string(words);
  }
  return canopen::sdo_abort_text(code);
}

void name_abort(const drive::Profile* profile, bool chinese, Error& error) {
  if (!error.abort_code) return;
  const auto generic = canopen::sdo_abort_text(*error.abort_code);
  const auto words = abort_words(profile, chinese, *error.abort_code);
  if (words == generic) return;
  // Of a standard code the manual has words in Chinese alone.
  if (!chinese && canopen::is_standard_sdo_abort(*error.abort_code)) return;
  error.message = error.message.changed([](auto literal) { return literal; },
                                        [&](Message::Argument& argument) {
                                          const auto* text = std::get_if<std::string>(&argument);
                                          if (text != nullptr && *text == generic) argument = Verbatim{words};
                                        });
}

Value marks_record(const std::vector<od::Mark>& marks) {
  if (marks.empty()) return {};
  Record out;
  for (const auto& mark : marks) {
    List lines;
    for (const auto line : mark.lines) lines.emplace_back(line);
    out.push_back({mark.field, std::move(lines)});
  }
  return out;
}

Record doubts_record(const od::Doubts& doubts) {
  const auto reason = [](const std::vector<od::Mark>& marks, std::string_view why) {
    return report::text_or_null(marks.empty() ? "" : od::to_text(marks) + ": " + std::string(why));
  };
  return {{"assumed", reason(doubts.assumed, "the manual does not state it"), Show::text},
          {"contradicted", reason(doubts.contradicted, "the manual also states another value"), Show::text},
          {"assumed", !doubts.assumed.empty(), Show::json},
          {"assumed_fields", marks_record(doubts.assumed), Show::json},
          {"contradicted", !doubts.contradicted.empty(), Show::json},
          {"contradicted_fields", marks_record(doubts.contradicted), Show::json}};
}

Value error_record(const Error& error, std::string_view abort_words) {
  return Record{{"code", name(error.code)},
                {"exit", exit_code(error.code)},
                {"message", error.message.text()},
                {"hint", report::text_or_null(error.hint.text())},
                {"axis"},
                {"node", error.node ? Value(*error.node) : Value()},
                {"object", error.object ? Value(to_string(*error.object)) : Value()},
                {"abort", abort_record(error, abort_words)},
                {"line", error.line ? Value(*error.line) : Value()}};
}

Value od_value(const std::optional<od::Value>& value) {
  if (!value) return {};
  if (const auto* i = std::get_if<std::int64_t>(&*value)) return *i;
  if (const auto* u = std::get_if<std::uint64_t>(&*value)) return *u;
  if (const auto* d = std::get_if<double>(&*value)) return *d;
  return od::to_string(*value);
}

Value labels_record(std::span<const od::EnumLabel> labels, bool chinese) {
  if (labels.empty()) return {};
  Record out;
  for (const auto& label : labels)
    out.push_back({formatted("{}", label.value), shown_name(label.label, label.label_zh, chinese)});
  return out;
}

Record parameter_record(const od::Parameter& p, bool chinese) {
  Record out{{"id", p.id},
             {"object", p.object ? Value(to_string(*p.object)) : Value(), Show::text},
             {"object", object_record(p.object), Show::json},
             {"name", shown_name(p.name, p.name_zh, chinese), Show::text},
             {"name", p.name, Show::json},
             {"name_zh", report::text_or_null(p.name_zh)},
             {"group", report::text_or_null(p.group)},
             {"type", od::name(p.type)},
             {"access", od::name(p.access)},
             {"unit", report::text_or_null(unit_text(p.unit, p.scale)), Show::text},
             {"unit", report::text_or_null(p.unit), Show::json},
             {"scale", p.scale, Show::json},
             {"default", od_value(p.default_value)},
             {"min", od_value(p.min)},
             {"max", od_value(p.max)},
             {"effect", report::text_or_null(std::string(od::name(p.effect)))},
             {"enum", labels_record(p.labels, chinese)},
             {"enum_zh", labels_record(p.labels, true), Show::json},
             {"flags", p.command || p.is_volatile || p.mirror ? Value(flags_of(p)) : Value(), Show::text},
             {"flags", words(flags_of(p)), Show::json},
             {"note", report::text_or_null(shown_name(p.note, p.note_zh, chinese)), Show::text},
             {"note", report::text_or_null(p.note), Show::json},
             {"note_zh", report::text_or_null(p.note_zh), Show::json},
             {"manual_line", p.line == 0 ? Value() : Value(p.line), Show::everywhere, "manual line"}};
  auto doubts = doubts_record(p.doubts);
  const auto note =
      std::find_if(out.begin(), out.end(), [](const auto& field) { return field.key == "note"; });
  out.insert(note, std::make_move_iterator(doubts.begin()), std::make_move_iterator(doubts.end()));
  return out;
}

Table parameter_table(std::span<const od::Parameter* const> parameters, bool chinese) {
  Table table;
  table.columns = {{"id", "", Show::text},      {"name", "", Show::text},  {"range", "", Show::text},
                   {"default", "", Show::text}, {"unit", "", Show::text},  {"access", "", Show::text},
                   {"effect", "", Show::text},  {"mark", "?!", Show::text}};
  bool first = true;
  for (const auto* p : parameters) {
    List row{p->id,
             shown_name(p->name, p->name_zh, chinese),
             range_of(*p),
             od_value(p->default_value),
             unit_text(p->unit, p->scale),
             od::name(p->access),
             od::name(p->effect),
             p->doubts.sign()};
    for (auto& field : parameter_record(*p, chinese)) {
      if (field.show == Show::text) continue;
      if (first) table.columns.push_back({field.key, "", Show::json});
      row.push_back(std::move(field.value));
    }
    first = false;
    table.rows.push_back(std::move(row));
  }
  explain_marks(table);
  return table;
}

void explain_marks(Table& table) {
  const auto mark = std::find_if(table.columns.begin(), table.columns.end(),
                                 [](const auto& column) { return column.key == "mark"; });
  if (mark == table.columns.end()) return;
  const auto at = static_cast<std::size_t>(mark - table.columns.begin());
  const bool any = std::any_of(table.rows.begin(), table.rows.end(), [&](const List& row) {
    const auto* sign = at < row.size() ? std::get_if<std::string>(&row[at].data()) : nullptr;
    return sign != nullptr && !sign->empty();
  });
  if (any)
    table.below.emplace_back(
        "a ? marks what the manual does not state, a ! what it states in two ways; `explain NAME` tells more");
}

Error located(Error error, std::uint8_t node, ObjectAddress object) {
  if (!error.node) error.node = node;
  if (!error.object) error.object = object;
  return error;
}

bool contains_nocase(std::string_view text, std::string_view word) {
  return lower(text).find(lower(word)) != std::string::npos;
}

bool fits(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern.front() == '*') {
    for (std::size_t skip = 0; skip <= text.size(); ++skip)
      if (fits(pattern.substr(1), text.substr(skip))) return true;
    return false;
  }
  return !text.empty() && equals_nocase(pattern.substr(0, 1), text.substr(0, 1)) &&
         fits(pattern.substr(1), text.substr(1));
}

}  // namespace servoctl::show
