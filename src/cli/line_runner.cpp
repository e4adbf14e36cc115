#include "cli/line_runner.hpp"

#include "cli/batch/batch_command.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "cli/words.hpp"

namespace servoctl::cli {

int LineRunner::run(std::string_view line) {
  const auto words = split_words(line);
  if (!words) return shell_->report_error(words.error(), shell_->defaults().json);
  if (words->empty()) return 0;
  exit_ = is_exit(*words);
  if (exit_) return 0;
  if (const auto outcome = choose(*shell_, *words))
    return outcome->errors.empty() ? 0 : show(shell_->console(), *outcome);
  return is_batch(*words) ? run_batch(*shell_, *words, {}) : shell_->run(*words);
}

}  // namespace servoctl::cli
