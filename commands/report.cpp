#include <algorithm>
#include <iterator>
#include <utility>

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/text.hpp"
#include "command/command.hpp"
#include "command/output_form.hpp"
#include "command/report_collection.hpp"
#include "trial/drive_report.hpp"
#include "trial/earlier_tests.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Value;

constexpr Parameter kReportParameters[] = {
    {.name = "file", .help = "FILE.html, or FILE.json for programs", .kind = Kind::file},
    {.name = "--output",
     .help = "the file, like FILE; or the output format: text, json, jsonl",
     .kind = Kind::file,
     .short_name = "-o"},
    {.name = "--title", .help = "title of the report (default: Commissioning report)", .kind = Kind::text},
    {.name = "--customer", .help = "for whom the report is made", .kind = Kind::text},
    {.name = "--machine", .help = "the machine that the drives belong to", .kind = Kind::text},
    {.name = "--operator", .help = "who commissioned it", .kind = Kind::text},
    {.name = "--logo",
     .help = "picture on the first page: PNG, JPEG or SVG, up to 1 MiB",
     .kind = Kind::file},
    {.name = "--signatures",
     .help = "who signs at the end, with commas between; none (default with --customer: Commissioning "
             "engineer,Customer)",
     .kind = Kind::text},
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
  return fail(Errc::usage, message("'{}' is not a report file name", as_it_is(file.string())),
              "use .html for people or .json for programs");
}

/// `report FILE` and `report -o FILE` are the same.
Result<std::filesystem::path> file_of(const Arguments& arguments) {
  const auto output = arguments.text("--output");
  const bool named = arguments.has("--output") && !is_output_form(output);
  if (named && arguments.has("file"))
    return fail(Errc::usage, message("'{}' and '{}': one file at a time", as_it_is(arguments.text("file")),
                                     as_it_is(output)));
  if (!named && !arguments.has("file"))
    return fail(Errc::usage, "which file?", "`report FILE.html` for people, `report FILE.json` for programs");
  return std::filesystem::path(named ? output : arguments.text("file"));
}

Result<trial::ReportCover> cover_of(const Context& context, const Arguments& arguments) {
  return trial::read_cover(context, {.title = arguments.text("--title"),
                                     .customer = arguments.text("--customer"),
                                     .machine = arguments.text("--machine"),
                                     .operator_name = arguments.text("--operator"),
                                     .logo = arguments.text("--logo"),
                                     .signatures = arguments.text("--signatures")});
}

Result<void> check_report(Context& context, const Arguments& arguments) {
  const auto file = file_of(arguments);
  if (!file) return fail(file.error());
  if (const auto form = form_of(*file); !form) return fail(form.error());
  const auto cover = cover_of(context, arguments);
  return cover ? Result<void>() : fail(cover.error());
}

Result<Value> run_report(Context& context, const Arguments& arguments) {
  const auto named = file_of(arguments);
  if (!named) return fail(named.error());
  const auto& file = *named;
  const auto form = form_of(file);
  if (!form) return fail(form.error());
  context.json = *form == Form::json;  // Of the file; the result has no words.
  std::vector<trial::EarlierTest> earlier;
  for (const auto& tests : arguments.all("--tests")) {
    auto read = trial::read_tests(context, tests);
    if (!read) return fail(read.error());
    std::move(read->begin(), read->end(), std::back_inserter(earlier));
  }
  auto cover = cover_of(context, arguments);
  if (!cover) return fail(cover.error());
  const auto made = collect_report(context, std::move(*cover), std::move(earlier));
  if (!made) return fail(made.error());
  const auto text =
      *form == Form::html ? trial::report_page(context, *made) : trial::report_json(context, *made);
  const auto written = write_file_atomically(file, text);
  if (!written) return fail(written.error());
  report::Record out{{"file", file.string()},
                     {"nodes", made->drives.size(), report::Show::everywhere, "number of nodes"}};
  for (const auto& field : made->head)
    if (field.key.starts_with("tests")) out.push_back(field);
  return Value(std::move(out));
}

constexpr Example kReportExamples[] = {
    {"report lift.html -n 1 -d gsd600 --title \"Lift, cell 3\"", "a page to print and to hand over"},
    {"report lift.html --tests test.json -n 1 -d gsd600", "with the tests that were made before"},
    {"report lift.html --lang zh -n 1 -d gsd600", "in Chinese"},
};

}  // namespace

extern const Command kReport;
const Command kReport{
    .path = "report",
    .summary = "Write a commissioning report: one page, or JSON",
    .details =
        "Identity and firmware, state, faults and their history, settings not at factory value, PDOs, other "
        "nodes on the bus, and a communication test; with --tests also results and plots of earlier tests, "
        "refused if they are from another drive. The page needs no network and prints on A4, each drive on a "
        "new sheet; --lang zh makes it Chinese. --customer, --machine, --operator and --logo stand on the first "
        "page, lines to be signed (--signatures) at the end; the picture is part of the file. Moves nothing and "
        "changes nothing. Axes of several buses and families are in one report, each with what the cabinet file "
        "says of it and whether its drive holds that. The file is written whole or not at all; exit code 1 when "
        "a test in it failed.",
    .parameters = kReportParameters,
    .examples = kReportExamples,
    .needs = Needs::node | Needs::dictionary,
    .effect = Effect::reads,
    .family = FamilyCheck::always,
    .run = run_report,
    .check = check_report,
    .joins = true,
};

}  // namespace servoctl::commands
