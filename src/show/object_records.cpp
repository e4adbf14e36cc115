#include "show/object_records.hpp"

#include <algorithm>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"

namespace servoctl::show {
namespace {

using report::Record;
using report::Show;
using report::Value;

Value default_of(const std::optional<od::NodeValue>& value) {
  if (!value) return {};
  if (!value->plus_node_id) return od_value(value->value);
  const auto* number = std::get_if<std::uint64_t>(&value->value);
  return number != nullptr ? formatted("$NODEID+0x{:X}", *number) : "$NODEID+" + od::to_string(value->value);
}

/// A float carried by an integer is shown as the number it is, beside its unit; bits in hexadecimal.
Value shown_default(const drive::Meaning& meaning, const od::Entry& entry) {
  const auto& value = entry.default_value;
  const bool as_it_is = meaning.encoding == od::Encoding::plain && !meaning.bits;
  if (!value || value->plus_node_id || as_it_is) return default_of(value);
  return drive::plain_text(meaning, value->value);
}

std::string denotation_of(const std::vector<od::EntryNote>& notes, ObjectAddress address) {
  const auto found =
      std::lower_bound(notes.begin(), notes.end(), address,
                       [](const od::EntryNote& note, ObjectAddress at) { return note.address < at; });
  return found == notes.end() || found->address != address ? std::string() : found->denotation;
}

const std::vector<od::EnumLabel>& labels_of(const drive::Meaning& meaning) {
  static const std::vector<od::EnumLabel> kNone;
  return meaning.labels != nullptr ? *meaning.labels : kNone;
}

std::string unit_of(const drive::Meaning& meaning) {
  return meaning.scale == 1 ? std::string(meaning.unit)
                            : formatted("{} {}", plain_number(meaning.scale, 6), meaning.unit);
}

}  // namespace

Record object_record(const drive::Profile& profile, const od::Object& object, const od::Entry& entry,
                     bool chinese) {
  // A panel parameter has its Chinese name, unit and labels in the parameter table.
  const auto target = drive::target_at(&profile, entry.address);
  const auto meaning = drive::meaning(target, 0);
  const auto* parameter = target.parameter;
  const auto name_zh = parameter != nullptr ? parameter->name_zh : entry.name_zh;
  const auto& doubts = parameter != nullptr ? parameter->doubts : entry.doubts;
  return {{"object", to_string(entry.address), Show::text},
          {"name_text", chinese && !name_zh.empty() ? name_zh : entry.name, Show::text, "name"},
          {"type", od::name(entry.type)},
          {"access", od::name(entry.access)},
          {"pdo", od::name(entry.pdo)},
          {"unit_text", unit_of(meaning), Show::text, "unit"},
          {"default_text", shown_default(meaning, entry), Show::text, "default"},
          {"default", default_of(entry.default_value), Show::json},
          {"value", default_of(entry.configured)},
          {"denotation", report::text_or_null(denotation_of(profile.notes, entry.address))},
          {"index", entry.address.index, Show::json},
          {"sub", entry.address.sub, Show::json},
          {"name", entry.name, Show::json},
          {"name_zh", report::text_or_null(name_zh), Show::json},
          {"identifier", drive::entry_name(object, entry), Show::json},
          {"unit", report::text_or_null(std::string(meaning.unit)), Show::json},
          {"scale", meaning.scale, Show::json},
          {"min", default_of(entry.low), Show::json},
          {"max", default_of(entry.high), Show::json},
          {"effect", report::text_or_null(std::string(od::name(meaning.effect))), Show::json},
          {"enum", labels_record(labels_of(meaning), false), Show::json},
          {"note", report::text_or_null(parameter != nullptr ? parameter->note : entry.note), Show::json},
          {"parameter", parameter != nullptr ? Value(parameter->id) : Value(), Show::json},
          {"encoding", report::text_or_null(std::string(od::name(meaning.encoding))), Show::json},
          {"note_zh", report::text_or_null(parameter != nullptr ? parameter->note_zh : entry.note_zh),
           Show::json},
          {"mark", doubts.sign(), Show::text, "?!"},
          {"assumed", !doubts.assumed.empty(), Show::json},
          {"assumed_fields", marks_record(doubts.assumed), Show::json},
          {"contradicted", !doubts.contradicted.empty(), Show::json},
          {"contradicted_fields", marks_record(doubts.contradicted), Show::json}};
}

void add_object_row(report::Table& table, Record record) {
  report::List row;
  row.reserve(record.size());
  for (auto& field : record) {
    if (table.rows.empty())
      table.columns.push_back({std::move(field.key), std::move(field.title), field.show});
    row.push_back(std::move(field.value));
  }
  table.rows.push_back(std::move(row));
}

Record object_details(const drive::Profile& profile, const od::Object& object, const od::Entry& entry,
                      bool chinese) {
  auto out = object_record(profile, object, entry, chinese);
  std::erase_if(out, [](const report::Field& field) { return field.key == "mark"; });
  for (auto& field : out)
    if (const auto* text = std::get_if<std::string>(&field.value.data());
        field.show == Show::text && text != nullptr && text->empty())
      field.value = Value();
  const auto meaning = drive::meaning(drive::target_at(&profile, entry.address), 0);
  const auto add = [&](std::string_view key, Value value) {
    out.push_back({std::string(key), std::move(value), Show::text});
  };
  add("min", default_of(entry.low));
  add("max", default_of(entry.high));
  add("effect", report::text_or_null(std::string(od::name(meaning.effect))));
  add("values", labels_record(labels_of(meaning), chinese));
  for (auto& field : doubts_record(entry.doubts))
    if (field.show == Show::text) out.push_back(std::move(field));
  const bool in_chinese = chinese && !entry.note_zh.empty();
  add("note", report::text_or_null(in_chinese ? entry.note_zh : entry.note));
  return out;
}

std::vector<std::string> object_values(const drive::Profile& profile, const od::Entry& entry, bool chinese) {
  std::vector<std::string> out;
  const auto meaning = drive::meaning(drive::target_at(&profile, entry.address), 0);
  for (const auto& label : labels_of(meaning)) {
    const bool in_chinese = chinese && !label.label_zh.empty();
    out.push_back(formatted("{} {}", label.value, in_chinese ? label.label_zh : label.label));
  }
  return out;
}

Result<void> check_parameters(const drive::Profile& profile) {
  if (!profile.parameters.empty()) return {};
  return fail(Errc::negative, message("{} has no panel parameters", as_it_is(profile.family)),
              message("`objects -d {}` lists its objects", as_it_is(profile.family)));
}

}  // namespace servoctl::show
