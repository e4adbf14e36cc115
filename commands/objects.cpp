#include <algorithm>

#include "base/format.hpp"
#include "command/command.hpp"
#include "drive/naming.hpp"
#include "show/object_records.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kObjectsParameters[] = {
    {.name = "pattern", .help = "part of a name, or an index with *: 0x60*", .kind = Kind::text},
};

bool wanted_object(std::string_view pattern, const od::Object& object, const od::Entry& entry) {
  if (pattern.empty()) return true;
  const auto address = to_string(entry.address);
  const auto name = object.name + " " + entry.name + " " + drive::entry_name(object, entry);
  if (pattern.find('*') != std::string_view::npos)
    return show::fits(pattern, address) || show::fits(pattern, entry.name) ||
           show::fits(pattern, drive::entry_name(object, entry));
  if (const auto exact = parse_object_address(pattern)) return exact->index == entry.address.index;
  return show::contains_nocase(name, pattern) ||
         show::contains_nocase(object.name_zh + " " + entry.name_zh, pattern);
}

/// Of an object that is asked for by its index, what its values stand for.
void add_values(const Context& context, const od::Entry& entry, report::Table& table) {
  const auto values = show::object_values(*context.profile, entry, context.chinese);
  if (values.empty()) return;
  table.below.push_back(formatted("values of {}:", to_string(entry.address)));
  for (const auto& value : values) table.below.push_back("  " + value);
}

Result<report::Value> run_objects(Context& context, const Arguments& arguments) {
  const auto& profile = *context.profile;
  const auto pattern = arguments.text("pattern");
  report::Table table;
  std::vector<const od::Entry*> shown;
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries)
      if (wanted_object(pattern, object, entry)) {
        show::add_object_row(table, show::object_record(profile, object, entry, context.chinese));
        shown.push_back(&entry);
      }
  if (shown.empty())
    return fail(Errc::negative,
                message("no object of {} matches '{}'", as_it_is(profile.family), as_it_is(pattern)),
                "try a shorter word, or 0x60* for a range of indexes");
  show::explain_marks(table);
  if (parse_object_address(pattern))
    for (const auto* entry : shown) add_values(context, *entry, table);
  if (profile.configured_node != 0)
    context.notices.push_back(message("{} is the configuration of node {}", as_it_is(profile.family),
                                      node_name(profile.configured_node)));
  return report::Value(std::move(table));
}

constexpr Example kObjectsExamples[] = {
    {"objects '0x60*' -d gsd600", "those from 6000h to 60FFh"},
    {"objects 0x6041", "a standard object; without -d"},
    {"objects homing -d da200", "those with this word in the name"},
};

}  // namespace

extern const Command kObjects;
const Command kObjects{
    .path = "objects",
    .summary = "List the object dictionary of a drive family",
    .details =
        "Works without a bus; without -d it lists the objects of the standards (CiA 301, CiA 402). The pattern is part of a name in English or Chinese, an index, or an index "
        "with `*`; for a single index the meanings of its values are listed too. For a DCF, value and "
        "denotation are those of each entry (ParameterValue, Denotation). `-d FILE.xml` lists what the ESI of "
        "an EtherCAT device describes, `-d FILE.xml#2` the second device of several; with a node on EtherCAT, -d online or nothing "
        "lists what the drive says of its own objects. `?` marks what the manual does not "
        "state, `!` what it states inconsistently; --json gives the line numbers.",
    .parameters = kObjectsParameters,
    .examples = kObjectsExamples,
    .needs = Needs::dictionary,
    .effect = Effect::none,
    .standard_without = true,
    .run = run_objects,
};

}  // namespace servoctl::commands
