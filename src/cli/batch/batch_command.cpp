#include "cli/batch/batch_command.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <iterator>

#include "base/file.hpp"
#include "cli/batch/batch_check.hpp"
#include "cli/batch/batch_frames.hpp"
#include "cli/batch/batch_plan.hpp"
#include "cli/batch/batch_run.hpp"
#include "cli/output_files.hpp"
#include "cli/restriction.hpp"
#include "show/records.hpp"

namespace servoctl::cli {
namespace {

constexpr std::string_view kPath = "run";
constexpr std::uintmax_t kMostBytes = 16U << 20U;

/// Puts the defaults of the shell back.
class KeepDefaults {
 public:
  explicit KeepDefaults(Shell& shell) : shell_(&shell), defaults_(shell.defaults()) {}
  KeepDefaults(const KeepDefaults&) = delete;
  KeepDefaults& operator=(const KeepDefaults&) = delete;
  ~KeepDefaults() { shell_->defaults() = std::move(defaults_); }

 private:
  Shell* shell_;
  Settings defaults_;
};

Result<std::string> read_batch(const std::string& file, const StandardText& input) {
  if (file != "-") return read_file(file, kMostBytes);
  if (!input) return fail(Errc::usage, "standard input already supplies these lines", "name a file");
  return input();
}

Result<Variables> variables_of(const command::Arguments& arguments) {
  Variables out;
  for (const auto& assignment : arguments.all("--var"))
    if (const auto fixed = out.fix(assignment); !fixed) {
      auto error = fixed.error();
      error.message = "--var: " + error.message;
      return fail(std::move(error));
    }
  return out;
}

Outcome checked(const std::string& file, std::size_t lines, std::vector<Error> errors,
                const Settings& settings) {
  std::stable_sort(errors.begin(), errors.end(),
                   [](const Error& a, const Error& b) { return a.line < b.line; });
  report::List list;
  for (auto& error : errors) {
    list.emplace_back(show::error_record(error));
    error = at_line(file, *error.line, std::move(error));
  }
  report::Record result{{"file", file}, {"lines", lines}, {"errors", std::move(list), report::Show::json}};
  Outcome out{.command = std::string(kPath), .settings = settings, .errors = std::move(errors)};
  // In text the errors say it all.
  if (out.errors.empty() || settings.json) out.result = std::move(result);
  return out;
}

Outcome planned(std::span<const Step> steps, const Settings& settings) {
  report::Table table;
  table.columns = {{"line"}, {"text", "command"}};
  for (const auto& step : steps) table.rows.push_back({step.line, step.text});
  return {.command = std::string(kPath), .settings = settings, .result = std::move(table)};
}

/// What would keep the run from coming to its end. A line whose failure does not matter (`on-error continue`)
/// is not checked beforehand.
std::vector<Error> errors_before_run(Shell& shell, std::span<const Step> steps, bool all) {
  auto errors = check_steps(shell, steps);
  if (all) return errors;
  std::erase_if(errors, [&](const Error& e) {
    return std::all_of(steps.begin(), steps.end(),
                       [&](const Step& s) { return s.line != e.line || s.goes_on; });
  });
  return errors;
}

/// The bus of the run, which may be named as in the cabinet file; without one those of that file.
Result<Restriction> restriction_of(Shell& shell, const Settings& settings, const std::string& file) {
  const auto folder = file == "-" ? std::filesystem::path() : std::filesystem::path(file).parent_path();
  const auto cabinet = shell.cabinet(settings);
  if (!cabinet) return fail(cabinet.error());
  const auto* bus = *cabinet == nullptr ? nullptr : (*cabinet)->bus(settings.bus);
  std::vector<std::string> buses;
  if (!settings.bus.empty()) buses.push_back(bus != nullptr ? bus->url : settings.bus);
  if (settings.bus.empty() && *cabinet != nullptr)
    for (const auto& each : (*cabinet)->buses) buses.push_back(each.url);
  return Restriction(folder, buses);
}

/// What the options of the run itself need before its file is read.
Result<std::optional<Restriction>> prepare_run(Shell& shell, const ParsedLine& line,
                                               const Settings& settings) {
  const bool runs = !line.arguments.has("--check") && !settings.dry_run;
  command::Context context;
  const RunningLine asked(shell, settings, context);
  if (runs)
    if (const auto may = admit_outputs(*line.command, line.arguments, settings, context); !may)
      return fail(may.error());
  if (!line.arguments.has("--restricted")) return std::optional<Restriction>();
  auto restriction = restriction_of(shell, settings, std::string(line.arguments.text("file")));
  if (!restriction) return fail(restriction.error());
  return std::optional(std::move(*restriction));
}

int run_file(Shell& shell, const command::Arguments& arguments, const StandardText& input) {
  const auto settings = shell.defaults();
  const std::string file(arguments.text("file"));
  const auto report = [&](const Error& error) {
    return show(shell.console(), failed(error, settings, kPath));
  };
  auto variables = variables_of(arguments);
  if (!variables) return report(variables.error());
  const auto text = read_batch(file, input);
  if (!text) return report(text.error());
  const auto name = file == "-" ? std::string("standard input") : file;
  auto batch = parse_batch(*text);
  auto plan = plan_batch(batch, std::move(*variables), std::filesystem::path(file).parent_path());
  auto errors = std::move(batch.errors);
  const bool only_check = arguments.has("--check");
  if (arguments.has("--frames") && !settings.dry_run)
    return report(fail(Errc::usage, "--frames goes with --dry-run", "run FILE --dry-run --frames").value());
  std::move(plan.errors.begin(), plan.errors.end(), std::back_inserter(errors));
  auto more = errors_before_run(shell, plan.steps, only_check || settings.dry_run);
  std::move(more.begin(), more.end(), std::back_inserter(errors));
  if (only_check || !errors.empty())
    return show(shell.console(), checked(name, plan.steps.size(), std::move(errors), settings));
  if (settings.dry_run && arguments.has("--frames"))
    return show(shell.console(), planned_frames(shell, plan.steps, name));
  if (settings.dry_run) return show(shell.console(), planned(plan.steps, settings));
  return run_steps(shell, plan.steps, name);
}

}  // namespace

bool is_batch(const std::vector<std::string>& words) {
  const auto match = match_command(words);
  return match.command != nullptr && match.command->path == kPath && !asks_for_help(words);
}

int run_batch(Shell& shell, const std::vector<std::string>& words, const StandardText& input) {
  const auto parsed = parse_line(words);
  // The shell tells what is wrong with the line.
  if (!parsed) return shell.run(words);
  const auto applied = apply_options(shell.defaults(), parsed->arguments);
  if (!applied) return shell.run(words);
  const auto settings = shell.settings_for_lines(*applied);
  if (!settings) return show(shell.console(), failed(settings.error(), *applied, kPath));
  auto restriction = prepare_run(shell, *parsed, *settings);
  if (!restriction) return show(shell.console(), failed(restriction.error(), *settings, kPath));
  const RestrictedRun restricted(std::move(*restriction));
  const KeepDefaults keep(shell);
  shell.defaults() = *settings;
  return run_file(shell, parsed->arguments, input);
}

}  // namespace servoctl::cli
