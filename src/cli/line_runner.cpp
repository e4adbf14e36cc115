#include "cli/line_runner.hpp"

#include <fmt/format.h>

#include "base/printable.hpp"
#include "cli/batch/batch_command.hpp"
#include "cli/last_write.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "cli/words.hpp"

namespace servoctl::cli {
namespace {

/// `undo`, `undo --yes`; the exit code.
int undo_line(Shell& shell, const std::vector<std::string>& words) {
  const bool yes = words.size() == 2 && (words[1] == "--yes" || words[1] == "-y");
  if (words.size() == 1 || yes) return undo(shell, yes);
  return shell.report_error(
      make_error(Errc::usage, "'undo' takes nothing but --yes",
                 "it puts back what the last `param set` or `write` replaced, where that was written"),
      shell.defaults().json, "undo");
}

/// `log on FILE`, `log off`, `log`; the exit code.
int log_line(Shell& shell, const std::vector<std::string>& words) {
  auto& console = shell.console();
  const bool on = words.size() == 3 && words[1] == "on";
  if (!on && !(words.size() == 2 && words[1] == "off") && words.size() != 1)
    return shell.report_error(
        make_error(Errc::usage, "'log' takes `on FILE` or `off`", "log on commissioning.log"),
        shell.defaults().json, "log");
  if (on) {
    auto log = LineLog::open(words[2]);
    if (!log) return shell.report_error(log.error(), shell.defaults().json, "log");
    console.set_log(std::move(*log));
  }
  const auto name = console.log() == nullptr ? std::string() : console.log()->name();
  const auto told = name.empty() ? std::string("there is no log")
                    : words.size() == 2
                        ? fmt::format("all that is typed and answered went into {}", printable(name))
                        : fmt::format("all that is typed and answered goes into {}", printable(name));
  console.note("notice: " + told + "\n");
  if (words.size() == 2) console.set_log(nullptr);
  return 0;
}

}  // namespace

int LineRunner::run(std::string_view line) {
  shell_->console().log_typed(line);
  const auto words = split_words(line);
  const auto chinese = shell_->defaults().chinese;
  shell_->console().set_chinese(words ? wants_chinese(*words, chinese) : chinese);
  if (!words) return shell_->report_error(words.error(), shell_->defaults().json);
  if (words->empty()) return 0;
  exit_ = is_exit(*words);
  if (exit_) return 0;
  if (const auto outcome = choose(*shell_, *words))
    return outcome->errors.empty() ? 0 : show(shell_->console(), *outcome);
  if (words->front() == "undo") return undo_line(*shell_, *words);
  if (words->front() == "log") return log_line(*shell_, *words);
  auto& last = shell_->last_write();
  last.set_place(shell_->defaults().nodes);
  last.set_enabled(shell_->stays_open() && !is_batch(*words));
  if (is_batch(*words)) return run_batch(*shell_, *words, {});
  return show_ ? show_(shell_->perform(*words), *words) : shell_->run(*words);
}

}  // namespace servoctl::cli
