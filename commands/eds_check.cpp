#include <fmt/format.h>

#include "base/file.hpp"
#include "commands/command.hpp"
#include "od/eds.hpp"

namespace servoctl::commands {
namespace {

using report::Show;

constexpr Parameter kParameters[] = {
    {.name = "file", .help = "an EDS or DCF file", .kind = Kind::file, .required = true, .many = true},
};

report::Record check(Context& context, const std::string& path, const od::EdsFile& file) {
  report::Table findings;
  findings.columns = {{"line"}, {"column", "", Show::json}, {"severity"}, {"rule"}, {"message"}, {"remedy"}};
  for (const auto& finding : file.diagnostics)
    findings.rows.push_back({finding.line, finding.column,
                             finding.severity == od::Severity::error ? "error" : "warning", finding.rule,
                             finding.message, finding.remedy});
  const auto errors = file.error_count();
  if (errors > 0) {
    Error error;
    error.code = Errc::negative;
    error.message = fmt::format("{}: {} error{}", path, errors, errors == 1 ? "" : "s");
    error.hint = "the remedy column says what to change; everything else in the file is usable";
    context.errors.push_back(std::move(error));
  }
  const bool clean = findings.rows.empty();
  return {{"file", path},
          {"product", report::text_or_null(file.device.product_name)},
          {"vendor", report::text_or_null(file.device.vendor_name)},
          {"objects", file.dictionary.objects().size()},
          {"entries", file.dictionary.entry_count()},
          {"errors", errors},
          {"warnings", file.warning_count()},
          {"findings", clean ? report::Value() : report::Value(findings), Show::text},
          {"findings", std::move(findings), Show::json}};
}

Result<report::Value> run(Context& context, const Arguments& arguments) {
  report::List out;
  for (const auto& path : arguments.all("file")) {
    const auto text = read_file(path, od::kMostEdsBytes);
    const auto file = text ? od::read_eds(*text, path) : tl::unexpected<Error>(text.error());
    if (file)
      out.emplace_back(check(context, path, *file));
    else
      context.errors.push_back(file.error());
  }
  return out.empty() ? report::Value() : report::Value(std::move(out));
}

}  // namespace

extern const Command kEdsCheck;
const Command kEdsCheck{
    .path = "eds check",
    .summary = "Check EDS and DCF files against CiA 306",
    .details =
        "Every finding has line, rule and remedy. Exit code 1 when there are errors; warnings alone are "
        "fine.",
    .parameters = kParameters,
    .needs = Needs::nothing,
    .effect = Effect::none,
    .run = run,
};

}  // namespace servoctl::commands
