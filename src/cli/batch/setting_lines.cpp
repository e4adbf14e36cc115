#include "cli/batch/setting_lines.hpp"

#include "base/format.hpp"
#include "cli/batch/batch.hpp"
#include "cli/batch/batch_plan.hpp"
#include "cli/terminal/prompt_words.hpp"

namespace servoctl::cli {
namespace {

tl::unexpected<Error> in_line(const std::string& file, std::uint32_t line, Error error) {
  error.code = Errc::file;
  error.message = message("{}:{}: {}", as_it_is(file), line, error.message);
  error.line = line;
  return fail(std::move(error));
}

Result<settings::SettingLine> line_of(const Settings& base, const std::vector<std::string>& words) {
  auto parsed = parse_line(words);
  if (!parsed) return fail(parsed.error());
  const auto chosen = apply_options(base, parsed->arguments);
  if (!chosen) return fail(chosen.error());
  const auto& command = *parsed->command;
  settings::SettingLine out{.line = 0,
                            .nodes = {},
                            .family = chosen->drive,
                            .values = command.settings != nullptr ? command.settings(parsed->arguments)
                                                                  : settings::writes_no_value(command.path)};
  if (chosen->nodes.empty()) return out;
  auto nodes = parse_nodes(chosen->nodes);
  if (!nodes) return fail(nodes.error());
  out.nodes = std::move(*nodes);
  return out;
}

}  // namespace

Result<std::vector<settings::SettingLine>> setting_lines(Shell& shell, std::string_view text,
                                                         const std::string& file) {
  const auto batch = parse_batch(text);
  const auto plan = plan_batch(batch, Variables{}, std::filesystem::path(file).parent_path());
  for (const auto* errors : {&batch.errors, &plan.errors})
    if (!errors->empty()) return in_line(file, errors->front().line.value_or(1), errors->front());
  Settings chosen_now;
  std::vector<settings::SettingLine> out;
  for (const auto& step : plan.steps) {
    if (step.kind != Step::Kind::command || is_exit(step.words))
      return in_line(file, step.line,
                     fail(Errc::file, message("'{}' writes no value", as_it_is(step.text)),
                          "a batch file read as settings may only contain lines that write")
                         .value());
    auto next = chosen(shell, chosen_now, step.words);
    if (!next) return in_line(file, step.line, next.error());
    chosen_now = std::move(*next);
    if (is_choice(step.words)) continue;
    auto line = line_of(chosen_now, step.words);
    const bool foreign = out.empty() && match_command(step.words).command == nullptr;
    if (!line && foreign && !line.error().hint.says("did you mean"))
      return fail(
          Errc::file,
          message("{} is neither a backup, a DCF, a table nor a list of command lines", as_it_is(file)),
          "`backup FILE` writes a file that can be read here");
    if (!line) return in_line(file, step.line, line.error());
    line->line = step.line;
    out.push_back(std::move(*line));
  }
  return out;
}

}  // namespace servoctl::cli
