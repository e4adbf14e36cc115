#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <iostream>

#include "base/file.hpp"
#include "command/command.hpp"
#include "od/eds.hpp"
#include "show/records.hpp"

namespace servoctl::commands {
namespace {

using namespace command;

using report::Show;

constexpr Parameter kParameters[] = {
    {.name = "file",
     .help = "an EDS or DCF file; - for standard input",
     .kind = Kind::file,
     .required = true,
     .many = true},
};

constexpr std::string_view kStandardInput = "-";

/// Standard input to its end, or as much as is too much.
std::string standard_input() {
  std::string out;
  std::array<char, 65536> chunk{};
  while (std::cin && out.size() <= od::kMostEdsBytes) {
    std::cin.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    out.append(chunk.data(), static_cast<std::size_t>(std::cin.gcount()));
  }
  return out;
}

Result<std::string> text_of(const Context& context, const std::string& path) {
  if (path != kStandardInput) return read_file(path, od::kMostEdsBytes);
  if (context.stays_open)
    return fail(Errc::usage, "standard input contains the command lines, and no file for this one",
                "name a file");
  return standard_input();
}

report::Table findings_of(const od::EdsFile& file) {
  report::Table out;
  out.columns = {
      {"line"},  {"column", "", Show::json}, {"section"}, {"key"}, {"severity"}, {"rule"}, {"message"},
      {"remedy"}};
  for (const auto& finding : file.diagnostics)
    out.rows.push_back({finding.line, finding.column, report::text_or_null(finding.section),
                        report::text_or_null(finding.key),
                        finding.severity == od::Severity::error ? "error" : "warning", finding.rule,
                        finding.message, finding.remedy});
  return out;
}

report::Record record_of(const std::string& path, const od::EdsFile& file) {
  auto findings = findings_of(file);
  return {{"file", path},
          {"product", report::text_or_null(file.device.product_name)},
          {"vendor", report::text_or_null(file.device.vendor_name)},
          {"objects", file.dictionary.objects().size()},
          {"entries", file.dictionary.entry_count()},
          {"errors", file.error_count()},
          {"warnings", file.warning_count()},
          {"findings", findings.rows.empty() ? report::Value() : report::Value(findings), Show::text},
          {"findings", std::move(findings), Show::json},
          {"error", report::Value(), Show::json}};
}

/// Of a file that cannot be used: its error stands in the list as well, so that no file is missing there.
report::Record record_of(const std::string& path, const Error& error, bool alone) {
  const auto show = alone ? Show::json : Show::everywhere;
  report::Record out{{"file", path, show}};
  for (const auto* key : {"product", "vendor", "objects", "entries", "errors", "warnings"})
    out.push_back({key, report::Value(), Show::json});
  out.push_back({"findings", report::List{}, Show::json});
  if (!alone) out.push_back({"error", error.message, Show::text});
  out.push_back({"error", show::error_record(error), Show::json});
  return out;
}

Error errors_error(const std::string& path, std::size_t errors) {
  return make_error(Errc::negative, fmt::format("{}: {} error{}", path, errors, errors == 1 ? "" : "s"),
                    "the remedy column says what to change; everything else in the file is usable");
}

Result<report::Value> run(Context& context, const Arguments& arguments) {
  report::List out;
  const auto paths = arguments.all("file");
  for (const auto& path : paths) {
    const auto text = text_of(context, path);
    const auto file = text ? od::read_eds(*text, path) : fail(text.error());
    if (!file) {
      context.errors.push_back(file.error());
      out.emplace_back(record_of(path, file.error(), paths.size() == 1));
      continue;
    }
    if (const auto errors = file->error_count(); errors > 0)
      context.errors.push_back(errors_error(path, errors));
    out.emplace_back(record_of(path, *file));
  }
  // The first error makes the exit code: the worst one, in whatever order the files are named.
  std::stable_sort(context.errors.begin(), context.errors.end(),
                   [](const Error& a, const Error& b) { return exit_code(a.code) > exit_code(b.code); });
  return report::Value(std::move(out));
}

}  // namespace

extern const Command kEdsCheck;
const Command kEdsCheck{
    .path = "eds check",
    .summary = "Check EDS and DCF files against CiA 306",
    .details =
        "Every finding gives line, section, key, rule and remedy, and what is used instead. Exit code 1 if "
        "there are errors; warnings alone are fine. A file that cannot be read is listed with its error; of "
        "several files the worst sets the exit code. `-` reads standard input to its end: in a pipe of "
        "command lines, what follows this line.",
    .parameters = kParameters,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run,
};

}  // namespace servoctl::commands
