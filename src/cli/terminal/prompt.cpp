#include "cli/terminal/prompt.hpp"

#include <editline/readline.h>
#include <langinfo.h>
#include <poll.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <clocale>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "base/file.hpp"
#include "base/printable.hpp"
#include "base/signal_wait.hpp"
#include "cli/line_runner.hpp"
#include "cli/state_folder.hpp"
#include "cli/terminal/completer.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

constexpr int kHistoryLines = 2000;
constexpr Duration kLongestWait = std::chrono::minutes(1);

class Prompt {
 public:
  Prompt(Shell& shell, Console& console) : shell_(&shell), console_(&console), runner_(shell) {
    shell.stay_open(true);
  }
  Prompt(const Prompt&) = delete;
  Prompt& operator=(const Prompt&) = delete;
  ~Prompt() {
    rl_callback_handler_remove();
    if (!history_.empty()) save_history();
    active_ = nullptr;
  }

  int run();

 private:
  /// The editor calls back without any argument of ours; only one prompt is active at a time.
  static Prompt* active_;

  static void on_line(char* line) { active_->take_line(line); }
  static char** on_complete(const char* text, int start, int end) {
    return active_->candidates(text, start, end);
  }
  static char* next_candidate(const char* text, int state);

  void take_line(char* line);
  char** candidates(const char* text, int start, int end);
  void install() {
    text_ = prompt_text();
    rl_callback_handler_install(text_.c_str(), on_line);
  }
  void save_history() const;
  std::string prompt_text() const;
  bool wait_for_key();
  bool terminal_takes() const;
  void show_notices();
  void drop_line();

  Shell* shell_;
  Console* console_;
  LineRunner runner_;
  std::string text_;
  std::string history_;
  Completions completions_;
  std::size_t next_ = 0;
  bool done_ = false;
  bool held_ = false;  ///< A key waits, and the terminal takes nothing: the editor would wait for it.
};

Prompt* Prompt::active_ = nullptr;

std::string Prompt::prompt_text() const { return printable("servoctl" + place_text(*shell_)) + "> "; }

/// The library writes a file from its beginning: one of ours, which then replaces the other as a whole.
void Prompt::save_history() const {
  const auto own = fmt::format("{}.{}", history_, ::getpid());
  const bool saved = write_history(own.c_str()) == 0;
  if (const auto lines = saved ? read_file(own) : Result<std::string>(std::string()); saved && lines)
    // What was typed is worth no word when it cannot be kept.
    (void)write_file_atomically(history_, *lines);
  ::unlink(own.c_str());
}

/// The editor reads characters, not bytes, by the locale; where that knows no UTF-8 (LANG=C), one that does.
void choose_characters() {
  const auto* chosen = std::setlocale(LC_CTYPE, "");
  if (chosen == nullptr || ::nl_langinfo(CODESET) != std::string_view("UTF-8"))
    (void)std::setlocale(LC_CTYPE, "C.UTF-8");
}

int Prompt::run() {
  active_ = this;
  choose_characters();
  rl_readline_name = const_cast<char*>("servoctl");  // NOLINT: the library's type is not const.
  rl_initialize();
  rl_catch_signals = 0;
  rl_attempted_completion_function = on_complete;
  // Names hold points and colons, options dashes: only a blank ends a word.
  rl_completer_word_break_characters = const_cast<char*>(" \t");  // NOLINT
  using_history();
  stifle_history(kHistoryLines);
  if (const auto folder = state_folder(); !folder.empty()) history_ = (folder / "history").string();
  if (!history_.empty()) read_history(history_.c_str());
  install();
  while (!done_ && !terminated()) {
    if (interrupted()) drop_line();
    if (wait_for_key()) rl_callback_read_char();
    if (!done_) show_notices();
  }
  shell_->let_go();
  return terminated() ? exit_code(Errc::interrupted) : 0;
}

/// True when a key waits; frames and timers of the bus are served meanwhile.
bool Prompt::wait_for_key() {
  pollfd wanted{STDIN_FILENO, POLLIN, 0};
  if (held_) wanted = {STDOUT_FILENO, POLLOUT, 0};
  const auto lost = [this](const Error& error) {
    console_->wipe_line();
    shell_->report_error(error, false);
    rl_forced_update_display();
  };
  if (!shell_->wait_for(wanted, kLongestWait, lost)) return false;
  const bool key = wanted.revents != 0;
  held_ = key && !terminal_takes();
  return key && !held_;
}

bool Prompt::terminal_takes() const {
  pollfd terminal{STDOUT_FILENO, POLLOUT, 0};
  return ::poll(&terminal, 1, 0) != 0;
}

void Prompt::show_notices() {
  const auto& settings = shell_->defaults();
  const auto loaded =
      settings.drive.empty() ? Result<const drive::Profile*>(nullptr) : shell_->profile(settings.drive);
  const auto notices = shell_->take_notices(loaded ? *loaded : nullptr, settings.chinese);
  if (notices.empty()) return;
  console_->wipe_line();
  for (const auto& notice : notices) console_->out("* " + printable(notice) + "\n");
  rl_forced_update_display();
}

void Prompt::drop_line() {
  clear_interrupt();
  rl_callback_handler_remove();
  console_->out("^C\n");
  install();
}

void Prompt::take_line(char* line) {
  rl_callback_handler_remove();
  if (line == nullptr) {
    console_->out("\n");
    done_ = true;
    return;
  }
  const std::string text(line);
  std::free(line);  // NOLINT: allocated by the library.
  if (text.find_first_not_of(" \t") != std::string::npos) add_history(text.c_str());
  runner_.run(text);
  clear_interrupt();
  done_ = runner_.wants_exit();
  if (!done_ && !terminated()) install();
}

char* Prompt::next_candidate(const char*, int state) {
  auto& self = *active_;
  if (state == 0) self.next_ = 0;
  if (self.next_ >= self.completions_.words.size()) return nullptr;
  return ::strdup(self.completions_.words[self.next_++].c_str());
}

char** Prompt::candidates(const char* text, int, int end) {
  completions_ = complete(std::string_view(rl_line_buffer, static_cast<std::size_t>(end)), *shell_);
  rl_attempted_completion_over = completions_.files ? 0 : 1;
  if (completions_.words.empty()) return nullptr;
  const bool opens = completions_.words.size() == 1 && completions_.words.front().back() == ':';
  rl_completion_append_character = opens ? 0 : ' ';
  return rl_completion_matches(text, next_candidate);
}

}  // namespace

int run_prompt(Shell& shell, Console& console) { return Prompt(shell, console).run(); }

}  // namespace servoctl::cli
