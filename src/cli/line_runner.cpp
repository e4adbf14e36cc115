#include "cli/line_runner.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "cli/batch/batch_command.hpp"
#include "cli/last_write.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "cli/words.hpp"
#include "show/output_file.hpp"

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

/// As LineLog writes the time of a line.
bool begins_with_time(std::string_view line) {
  constexpr std::string_view kForm = "0000-00-00T00:00:00.000Z";
  if (line.size() < kForm.size()) return false;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    const bool digit = line[i] >= '0' && line[i] <= '9';
    if (kForm[i] == '0' ? !digit : line[i] != kForm[i]) return false;
  }
  return true;
}

bool is_log(const std::string& file) {
  const can::Descriptor found(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!found) return false;
  char begin[32];
  const auto size = ::read(found.get(), begin, sizeof begin);
  return size > 0 && begins_with_time({begin, static_cast<std::size_t>(size)});
}

/// A log goes on where it ended; any other file is not written to without a question.
Result<void> may_log(Shell& shell, const std::string& file) {
  if (!show::is_replaced(file) || is_log(file)) return {};
  if (shell.defaults().read_only)
    return fail(Errc::refused, message("{} is no log, and --read-only changes no file", as_it_is(file)),
                "name a file that does not exist yet");
  command::Context context;
  RunningLine line(shell, shell.defaults(), context);
  return line.confirm(formatted("Add to the file {}, which is no log of servoctl?", file));
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
    if (const auto may = may_log(shell, words[2]); !may)
      return shell.report_error(may.error(), shell.defaults().json, "log");
    auto log = LineLog::open(words[2]);
    if (!log) return shell.report_error(log.error(), shell.defaults().json, "log");
    console.set_log(std::move(*log));
  }
  const auto name = console.log() == nullptr ? std::string() : console.log()->name();
  const auto told = name.empty() ? std::string("there is no log")
                    : words.size() == 2
                        ? formatted("all that is typed and answered went into {}", printable(name))
                        : formatted("all that is typed and answered goes into {}", printable(name));
  console.note("notice: " + told + "\n");
  if (words.size() == 2) console.set_log(nullptr);
  return 0;
}

}  // namespace

int LineRunner::run(std::string_view line) {
  shell_->console().log_typed(line);
  auto words = split_words(line);
  const auto chinese = shell_->defaults().chinese;
  shell_->console().set_chinese(words ? wants_chinese(*words, chinese) : chinese);
  if (!words) return shell_->report_error(words.error(), shell_->defaults().json);
  if (words->empty()) return 0;
  *words = as_parameter_line(std::move(*words));
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
