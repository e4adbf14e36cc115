#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commands/drive_report.hpp"
#include "commands/earlier_tests.hpp"
#include "commands/output_form.hpp"

namespace servoctl::commands {
namespace {

using report::Value;

constexpr Parameter kParameters[] = {
    {.name = "file", .help = "FILE.html, or FILE.json for programs", .kind = Kind::file},
    {.name = "--output",
     .help = "the file as well; or the form of the answer: text, json, jsonl",
     .kind = Kind::file,
     .short_name = "-o"},
    {.name = "--title", .help = "what stands above it: the machine, the axis", .kind = Kind::text},
    {.name = "--tests",
     .help = "results of earlier tests (test … --json >FILE); may be repeated",
     .kind = Kind::file,
     .repeats = true},
};

enum class Form : std::uint8_t { html, json };

Result<Form> form_of(const std::filesystem::path& file) {
  const auto extension = lower(file.extension().string());
  if (extension == ".html" || extension == ".htm") return Form::html;
  if (extension == ".json") return Form::json;
  return fail(Errc::usage, fmt::format("'{}' is no name for a report", file.string()),
              "it ends in .html for people or in .json for programs");
}

/// `report FILE` and `report -o FILE` are the same.
Result<std::filesystem::path> file_of(const Arguments& arguments) {
  const auto output = arguments.text("--output");
  const bool named = arguments.has("--output") && !is_output_form(output);
  if (named && arguments.has("file"))
    return fail(Errc::usage,
                fmt::format("'{}' and '{}': one file at a time", arguments.text("file"), output));
  if (!named && !arguments.has("file"))
    return fail(Errc::usage, "which file?", "`report FILE.html` for people, `report FILE.json` for programs");
  return std::filesystem::path(named ? output : arguments.text("file"));
}

Result<Value> run(Context& context, const Arguments& arguments) {
  const auto named = file_of(arguments);
  if (!named) return tl::unexpected<Error>(named.error());
  const auto& file = *named;
  const auto form = form_of(file);
  if (!form) return tl::unexpected<Error>(form.error());
  std::vector<report::TestResult> earlier;
  for (const auto& tests : arguments.all("--tests")) {
    auto read = read_tests(tests);
    if (!read) return tl::unexpected<Error>(read.error());
    for (auto& result : *read) earlier.push_back(std::move(result));
  }
  for (const auto& result : earlier)
    if (std::find(context.nodes.begin(), context.nodes.end(), result.node) == context.nodes.end())
      context.notices.push_back(fmt::format(
          "the test {} of node {} is not in the report: -n does not name it", result.test, result.node));
  if (const auto same = check_tested(context, earlier); !same) return tl::unexpected<Error>(same.error());
  const auto made = make_report(context, std::string(arguments.text("--title")), earlier);
  if (!made) return tl::unexpected<Error>(made.error());
  const auto text = *form == Form::html ? report_page(context, *made) : report_json(context, *made);
  const auto written = write_file_atomically(file, text);
  if (!written) return tl::unexpected<Error>(written.error());
  report::Record out{{"file", file.string()}, {"nodes", made->drives.size()}};
  for (const auto& field : made->head)
    if (field.key.starts_with("tests")) out.push_back(field);
  return Value(std::move(out));
}

}  // namespace

extern const Command kReport;
const Command kReport{
    .path = "report",
    .summary = "Write down what was commissioned: one page, or JSON",
    .details =
        "Identity and firmware, state, faults and their history, settings that differ from the factory's, "
        "PDOs, who else is on the bus, and a test of the communication; with --tests also the results and "
        "plots of tests made before, refused where they are of another drive. The page needs no network and "
        "prints on A4; --lang zh makes it Chinese. "
        "Moves nothing and changes nothing. The file is written whole or not at all; exit code 1 when a test "
        "in it failed.",
    .parameters = kParameters,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .family = FamilyCheck::always,
    .run = run,
};

}  // namespace servoctl::commands
