#include <system_error>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "drive/family_mistakes.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;

constexpr Parameter kDrivesCheckParameters[] = {
    {.name = "family",
     .help = "a family, or a folder with families; all families if left out",
     .kind = Kind::family},
};

/// The families to check, and where their parents are looked for.
struct Checked {
  std::vector<drive::Family> families;
  std::vector<std::filesystem::path> folders;
};

Result<Checked> checked_families(const Context& context, const std::string& word) {
  const std::span<const std::filesystem::path> known = context.drive_folders;
  Checked out{{}, {known.begin(), known.end()}};
  std::error_code ignored;
  if (word.find('/') != std::string::npos || word == ".") {
    if (!std::filesystem::is_directory(word, ignored))
      return fail(Errc::usage, message("{} is not a folder", as_it_is(word)),
                  "name a family, or the folder of its files");
    out.folders.insert(out.folders.begin(), word);
    out.families = drive::find_families(std::span(out.folders).first(1));
    if (out.families.empty())
      return fail(Errc::file, message("no drive family was found in {}", as_it_is(word)),
                  "a family needs a .toml, .eds, .dcf or .xml file");
    return out;
  }
  out.families = drive::find_families(known);
  if (word.empty()) return out;
  const auto* found = drive::find_family(out.families, word);
  if (found == nullptr) {
    std::vector<std::string> names;
    for (const auto& family : out.families) names.push_back(family.name);
    return fail(Errc::usage, message("no drive family is called '{}'", as_it_is(word)),
                did_you_mean(word, names));
  }
  out.families = {*found};
  return out;
}

report::Record family_record(const drive::Family& family, std::span<const drive::Mistake> found,
                             std::size_t mistakes) {
  report::Table findings;
  findings.columns = {{"file", "", Show::json},    {"line", "", Show::json},   {"severity"},
                      {"message", "", Show::json}, {"remedy", "", Show::json}, {"finding", "", Show::text}};
  for (const auto& one : found)
    findings.rows.push_back(
        {one.file, one.line ? report::Value(*one.line) : report::Value(), one.breaks ? "error" : "warning",
         one.message.text(), report::text_or_null(one.remedy.text()),
         one.remedy.empty() ? one.message.text()
                            : formatted("{}; {}", one.message.text(), one.remedy.text())});
  return {{"family", family.name},
          {"files", family.stem.string() + ".*", Show::text},
          {"files", family.stem.string(), Show::json},
          {"errors", mistakes},
          {"warnings", found.size() - mistakes},
          {"findings", findings.rows.empty() ? report::Value() : report::Value(findings), Show::text},
          {"findings", std::move(findings), Show::json}};
}

Result<report::Value> run_drives_check(Context& context, const Arguments& arguments) {
  const std::string word(arguments.has("family") ? arguments.text("family") : std::string_view());
  const auto checked = checked_families(context, word);
  if (!checked) return fail(checked.error());
  report::List out;
  for (const auto& family : checked->families) {
    const auto found = drive::mistakes_of(family, checked->folders);
    const auto mistakes = drive::count_errors(found);
    out.emplace_back(family_record(family, found, mistakes));
    if (mistakes > 0)
      context.errors.push_back(make_error(
          Errc::negative, message("{}: {} error{}", as_it_is(family.name), mistakes, plural(mistakes)),
          "correct them before you use the family: servoctl refuses to load it, or would use a name, size or type that is "
          "wrong"));
  }
  return report::Value(std::move(out));
}

constexpr Example kDrivesCheckExamples[] = {
    {"drives check gsd600", "one family: every error in every file, with what would be right"},
    {"drives check ./drives", "all families in a folder"},
};

}  // namespace

extern const Command kDrivesCheck;
const Command kDrivesCheck{
    .path = "drives check",
    .summary = "Check the files of drive families",
    .details =
        "Lists all errors of all files of a family at once, with file, line and what would be right. Errors in "
        "one file prevent loading the family; errors between files do not: names in the rules must be parameters or "
        "objects of the family, and parameters must have the type that the data sheet gives their objects. A warning "
        "is a finding in the data sheet that `eds check` explains, a file that servoctl does not read, or a parameter "
        "number that is also the name or address of an object. A TOML file with a syntax error is read up to "
        "the first one: check again after correcting it. Exit code 1 if there are errors.",
    .parameters = kDrivesCheckParameters,
    .examples = kDrivesCheckExamples,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run_drives_check,
};

}  // namespace servoctl::commands
