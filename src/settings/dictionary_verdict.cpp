#include "settings/dictionary_verdict.hpp"

#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::settings {
namespace {

using report::Show;
using report::Value;

constexpr std::string_view kTest = "eds verify";

/// For people; name() is for programs.
std::string_view in_words(Difference difference) {
  switch (difference) {
    case Difference::unlisted: return "not in the file";
    case Difference::limits: return "outside limits";
    case Difference::no_answer: return "no answer";
    default: return name(difference);
  }
}

report::Table findings_table(const DictionaryCheck& check) {
  report::Table table;
  table.columns = {{"object", "", Show::text},
                   {"index", "", Show::json},
                   {"sub", "", Show::json},
                   {"name"},
                   {"in_words", "finding", Show::text},
                   {"finding", "", Show::json},
                   {"file"},
                   {"drive"}};
  for (const auto& found : check.findings)
    table.rows.push_back({to_string(found.object), found.object.index, found.object.sub,
                          report::text_or_null(found.name), in_words(found.difference),
                          name(found.difference), report::text_or_null(found.file),
                          report::text_or_null(found.drive)});
  return table;
}

report::Table unchecked_table(const DictionaryCheck& check, bool with_empty) {
  report::Table table;
  table.columns = {{"object", "", Show::text},
                   {"index", "", Show::json},
                   {"sub", "", Show::json},
                   {"name"},
                   {"reason", "why"}};
  for (const auto& each : check.unchecked)
    if (with_empty || !each.is_empty)
      table.rows.push_back({to_string(each.object), each.object.index, each.object.sub,
                            report::text_or_null(each.name), each.reason});
  return table;
}

Value shown(report::Table table) { return table.rows.empty() ? Value() : Value(std::move(table)); }

using ByObject = std::map<ObjectAddress, std::vector<const DictionaryFinding*>>;

report::Criterion failed(const DictionaryFinding& first, const std::vector<const DictionaryFinding*>& all) {
  report::Criterion out;
  out.id = to_string(first.object);
  out.name = first.name;
  out.verdict = report::Verdict::failed;
  for (const auto* each : all)
    append(out.note,
           formatted("{}: file: {}, drive: {}", name(each->difference), each->file.empty() ? "-" : each->file,
                     each->drive.empty() ? "-" : each->drive),
           "; ");
  return out;
}

}  // namespace

report::TestResult dictionary_test(const od::EdsFile& file, const DictionaryCheck& check) {
  ByObject found;
  for (const auto& each : check.findings) found[each.object].push_back(&each);
  std::map<ObjectAddress, const UncheckedEntry*> unchecked;
  for (const auto& each : check.unchecked) unchecked[each.object] = &each;
  report::TestResult out;
  out.test = kTest;
  out.node = check.node;
  for (const auto& object : file.dictionary.objects())
    for (const auto& entry : object.entries) {
      if (found.contains(entry.address)) continue;
      const auto skipped = unchecked.find(entry.address);
      if (skipped != unchecked.end())
        out.criteria.push_back(
            report::skipped(to_string(entry.address), full_name({}, object, entry), skipped->second->reason));
      else
        out.criteria.push_back(
            {.id = to_string(entry.address), .name = full_name({}, object, entry), .relation = {}});
    }
  for (const auto& [object, all] : found) out.criteria.push_back(failed(*all.front(), all));
  return out;
}

report::TestResult dictionary_test(std::uint8_t node, const Error& error) {
  report::TestResult out;
  out.test = kTest;
  out.node = node;
  out.criteria.push_back({.id = "compared",
                          .name = "compared",
                          .verdict = report::Verdict::failed,
                          .relation = {},
                          .note = error.message.text()});
  return out;
}

report::Record dictionary_record(show::Desk& desk, const std::string& file, const DictionaryCheck& check) {
  const auto differences = check.findings.size();
  if (differences > 0)
    desk.errors.push_back(drive_error(
        Errc::negative, check.node,
        message("differences between {} and the drive: {}", as_it_is(file), differences),
        "the file is of another drive or firmware, or wrong in these entries: correct it before you use it with -d"));
  return {{"node", check.node},
          {"file", file},
          {"entries", check.entries, Show::everywhere, "entries of the file"},
          {"read", check.answered, Show::everywhere, "values read"},
          {"probed", check.probed, Show::everywhere, "others asked for"},
          {"not_default", check.not_default, Show::everywhere, "not at default"},
          {"differences", differences},
          {"not_compared", check.unchecked.size(), Show::text, "not compared"},
          {"findings", findings_table(check), Show::json},
          {"findings", shown(findings_table(check)), Show::text},
          {"unchecked", unchecked_table(check, true), Show::json},
          {"unchecked", shown(unchecked_table(check, false)), Show::text, "not compared"}};
}
}  // namespace servoctl::settings
