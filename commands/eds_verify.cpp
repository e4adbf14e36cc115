#include "base/file.hpp"
#include "base/format.hpp"
#include "command/command.hpp"
#include "command/standard_scope.hpp"
#include "command/trial_options.hpp"
#include "od/data_sheet.hpp"
#include "settings/dictionary_verdict.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

constexpr Parameter kEdsVerifyParameters[] = {
    {.name = "file", .help = "the EDS, DCF or ESI file of the drive", .kind = Kind::file, .required = true},
    {.name = "--listed", .help = "ask only for objects that the file lists", .kind = Kind::flag},
    {.name = "--factory",
     .help = "the drive is at factory values: another value than the default is a difference",
     .kind = Kind::flag},
    kJunitOption,
};

Result<od::EdsFile> sheet_of(Context& context, const std::string& word) {
  const auto text = od::read_sheet_file(word);
  if (!text) return fail(text.error());
  auto file = od::read_data_sheet(*text, word);
  if (file && file->error_count() > 0)
    context.notices.push_back(message("{0}: {1} errors; `eds check {0}` lists what is not compared",
                                      as_it_is(word), file->error_count()));
  return file;
}

Result<report::Value> run_eds_verify(Context& context, const Arguments& arguments) {
  const std::string word(arguments.text("file"));
  const auto file = sheet_of(context, word);
  if (!file) return fail(file.error());
  const StandardScope standard(context);
  const settings::CheckOptions options{.listed_only = arguments.has("--listed"),
                                       .factory = arguments.has("--factory")};
  std::vector<report::TestResult> results;
  report::List out;
  for (const auto node : context.nodes) {
    const auto check = settings::check_dictionary(context, node, *file, options);
    if (check) {
      out.emplace_back(settings::dictionary_record(context, word, *check));
      results.push_back(settings::dictionary_test(*file, *check));
      continue;
    }
    results.push_back(settings::dictionary_test(node, check.error()));
    const bool ends = check.error().code == Errc::interrupted || check.error().code == Errc::bus;
    // The exit code is that of the first error: what ended the command, not a difference found before.
    context.errors.insert(ends ? context.errors.begin() : context.errors.end(), check.error());
    if (ends) break;
  }
  if (arguments.has("--junit"))
    if (const auto written =
            write_file_atomically(std::string(arguments.text("--junit")), report::junit_xml(results));
        !written)
      context.errors.push_back(written.error());
  return report::Value(std::move(out));
}

constexpr Example kEdsVerifyExamples[] = {
    {"eds verify drive.eds -n 1", "what of the file is not true of this drive"},
    {"eds verify drive.eds --factory --junit eds.xml -n 1", "a drive as delivered, with a file for a CI"},
};

}  // namespace

extern const Command kEdsVerify;
const Command kEdsVerify{
    .path = "eds verify",
    .summary = "Compare an EDS, DCF or ESI file with a live drive",
    .details =
        "Reads every object of the file that can be read, and reports what the drive contradicts: `missing` "
        "objects, `unlisted` ones, another `type`, `size` or `access`, constants of another value (`default`), "
        "values outside of their `limits`, objects without an answer (`no-answer`). Exit code 1 if there is any. "
        "Objects that the file does not list are asked for where they are likely: neighbours of listed ones, "
        "standard objects, further sub-indices; on EtherCAT the drive lists its own. Not on a drive that is "
        "enabled, or that raises an alarm for an object which it does not have, and not with --listed. If the "
        "drive sends an EMCY meanwhile, nothing more is read. A setting may have another value than its default: "
        "such values are counted, and with --factory they are differences. Nothing is written, so that a "
        "sign, and whether an object can be written, stay open.",
    .parameters = kEdsVerifyParameters,
    .examples = kEdsVerifyExamples,
    .needs = Needs::node,
    .effect = Effect::reads,
    .run = run_eds_verify,
    .one_file = "--junit",
};

}  // namespace servoctl::commands
