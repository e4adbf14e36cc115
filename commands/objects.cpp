#include <fmt/format.h>
#include <algorithm>

#include "base/file.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "od/data_sheet.hpp"
#include "show/reading.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;
using report::Value;

constexpr Parameter kParameters[] = {
    {.name = "pattern", .help = "part of a name, or an index with *: 0x60*", .kind = Kind::text},
};

Value default_of(const std::optional<od::NodeValue>& value) {
  if (!value) return {};
  if (!value->plus_node_id) return show::od_value(value->value);
  const auto* number = std::get_if<std::uint64_t>(&value->value);
  return number != nullptr ? fmt::format("$NODEID+0x{:X}", *number)
                           : "$NODEID+" + od::to_string(value->value);
}

/// A float carried by an integer is shown as the number it is, beside its unit.
Value shown_default(const drive::Meaning& meaning, const od::Entry& entry) {
  const auto& value = entry.default_value;
  if (!value || value->plus_node_id || meaning.encoding == od::Encoding::plain) return default_of(value);
  return drive::plain_text(meaning, value->value);
}

bool wanted(std::string_view pattern, const od::Object& object, const od::Entry& entry) {
  if (pattern.empty()) return true;
  const auto address = to_string(entry.address);
  const auto name = object.name + " " + entry.name + " " + drive::entry_name(object, entry);
  if (pattern.find('*') != std::string_view::npos)
    return show::fits(pattern, address) || show::fits(pattern, entry.name) ||
           show::fits(pattern, drive::entry_name(object, entry));
  if (const auto exact = parse_object_address(pattern)) return exact->index == entry.address.index;
  return show::contains_nocase(name, pattern) || show::contains_nocase(entry.name_zh, pattern);
}

/// What the data sheet says beside the dictionary; nothing where there is none.
od::EdsFile data_sheet_of(const drive::Profile& profile) {
  if (profile.data_sheet.empty()) return {};
  const auto text = od::read_sheet_file(profile.data_sheet.string());
  if (!text || od::is_xml(*text)) return {};  // An ESI says nothing beside it.
  return od::read_eds(*text, profile.data_sheet.string()).value_or(od::EdsFile{});
}

std::string denotation_of(std::span<const od::EntryNote> notes, ObjectAddress address) {
  const auto found = std::find_if(notes.begin(), notes.end(),
                                  [&](const od::EntryNote& note) { return note.address == address; });
  return found == notes.end() ? std::string() : found->denotation;
}

const std::vector<od::EnumLabel>& labels_of(const drive::Meaning& meaning) {
  static const std::vector<od::EnumLabel> kNone;
  return meaning.labels != nullptr ? *meaning.labels : kNone;
}

void add_marks(const od::Doubts& doubts, report::List& row) {
  row.insert(row.end(), {doubts.sign(), !doubts.assumed.empty(), show::marks_record(doubts.assumed),
                         !doubts.contradicted.empty(), show::marks_record(doubts.contradicted)});
}

report::List row(const Context& context, const od::Object& object, const od::Entry& entry,
                 std::span<const od::EntryNote> notes) {
  // A panel parameter has its Chinese name, unit and labels in the parameter table.
  const auto target = drive::target_at(context.profile, entry.address);
  const auto meaning = drive::meaning(target, 0);
  const auto* parameter = target.parameter;
  const auto name_zh = parameter != nullptr ? parameter->name_zh : entry.name_zh;
  const auto shown = context.chinese && !name_zh.empty() ? name_zh : entry.name;
  const auto unit = meaning.scale == 1 ? std::string(meaning.unit)
                                       : fmt::format("{} {}", plain_number(meaning.scale, 6), meaning.unit);
  const auto& doubts = parameter != nullptr ? parameter->doubts : entry.doubts;
  const auto& note_zh = parameter != nullptr ? parameter->note_zh : entry.note_zh;
  const auto encoding = od::name(meaning.encoding);
  report::List out{to_string(entry.address),
                   shown,
                   od::name(entry.type),
                   od::name(entry.access),
                   od::name(entry.pdo),
                   unit,
                   shown_default(meaning, entry),
                   default_of(entry.default_value),
                   default_of(entry.configured),
                   report::text_or_null(denotation_of(notes, entry.address)),
                   entry.address.index,
                   entry.address.sub,
                   entry.name,
                   report::text_or_null(name_zh),
                   drive::entry_name(object, entry),
                   report::text_or_null(std::string(meaning.unit)),
                   meaning.scale,
                   default_of(entry.low),
                   default_of(entry.high),
                   report::text_or_null(std::string(od::name(meaning.effect))),
                   show::labels_record(labels_of(meaning), false),
                   report::text_or_null(parameter != nullptr ? parameter->note : entry.note),
                   parameter != nullptr ? Value(parameter->id) : Value(),
                   report::text_or_null(std::string(encoding)),
                   report::text_or_null(note_zh)};
  add_marks(doubts, out);
  return out;
}

/// What the values of an object stand for: a line each.
std::vector<std::string> values_of(const Context& context, const od::Entry& entry) {
  std::vector<std::string> out;
  const auto meaning = drive::meaning(drive::target_at(context.profile, entry.address), 0);
  if (meaning.labels == nullptr) return out;
  for (const auto& label : *meaning.labels) {
    const bool chinese = context.chinese && !label.label_zh.empty();
    out.push_back(fmt::format("{} {}", label.value, chinese ? label.label_zh : label.label));
  }
  return out;
}

/// Of an object that is asked for by its index, what its values stand for.
void add_values(const Context& context, const od::Entry& entry, report::Table& table) {
  const auto values = values_of(context, entry);
  if (values.empty()) return;
  table.below.push_back(fmt::format("values of {}:", to_string(entry.address)));
  for (const auto& value : values) table.below.push_back("  " + value);
}

Result<report::Value> run(Context& context, const Arguments& arguments) {
  report::Table table;
  table.columns = {{"object", "", Show::text},
                   {"name_text", "name", Show::text},
                   {"type"},
                   {"access"},
                   {"pdo"},
                   {"unit_text", "unit", Show::text},
                   {"default_text", "default", Show::text},
                   {"default", "", Show::json},
                   {"value"},
                   {"denotation"},
                   {"index", "", Show::json},
                   {"sub", "", Show::json},
                   {"name", "", Show::json},
                   {"name_zh", "", Show::json},
                   {"identifier", "", Show::json},
                   {"unit", "", Show::json},
                   {"scale", "", Show::json},
                   {"min", "", Show::json},
                   {"max", "", Show::json},
                   {"effect", "", Show::json},
                   {"enum", "", Show::json},
                   {"note", "", Show::json},
                   {"parameter", "", Show::json},
                   {"encoding", "", Show::json},
                   {"note_zh", "", Show::json},
                   {"mark", "?!", Show::text},
                   {"assumed", "", Show::json},
                   {"assumed_fields", "", Show::json},
                   {"contradicted", "", Show::json},
                   {"contradicted_fields", "", Show::json}};
  const auto sheet = data_sheet_of(*context.profile);
  const auto pattern = arguments.text("pattern");
  for (const auto& object : context.profile->dictionary.objects())
    for (const auto& entry : object.entries)
      if (wanted(pattern, object, entry)) {
        table.rows.push_back(row(context, object, entry, sheet.notes));
        if (parse_object_address(pattern)) add_values(context, entry, table);
      }
  if (table.rows.empty())
    return fail(Errc::negative, fmt::format("no object of {} matches '{}'", context.profile->family, pattern),
                "try a shorter word, or 0x60* for a range of indexes");
  if (sheet.node_id != 0)
    context.notices.push_back(
        fmt::format("{} is the configuration of node {}", context.profile->family, sheet.node_id));
  return report::Value(std::move(table));
}

}  // namespace

extern const Command kObjects;
const Command kObjects{
    .path = "objects",
    .summary = "List the object dictionary of a drive family",
    .details =
        "Works without a bus. The pattern is part of a name in English or Chinese, an index, or an index "
        "with `*`; for a single index the meanings of its values are listed too. For a DCF, value and "
        "denotation are those of each entry (ParameterValue, Denotation). `-d FILE.xml` lists what the ESI of "
        "an EtherCAT device describes, `-d FILE.xml#2` the second device of several; with a node on EtherCAT, -d online or nothing "
        "lists what the drive says of its own objects. `?` marks what the manual does not "
        "state, `!` what it states inconsistently; --json gives the line numbers.",
    .parameters = kParameters,
    .needs = Needs::dictionary,
    .effect = Effect::none,
    .run = run,
};

}  // namespace servoctl::commands
