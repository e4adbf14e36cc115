#include "cli/terminal/prompt.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "base/printable.hpp"
#include "cli/batch/batch_command.hpp"
#include "cli/last_place.hpp"
#include "cli/line_runner.hpp"
#include "cli/state_folder.hpp"
#include "cli/terminal/completer.hpp"
#include "cli/terminal/line_editor.hpp"
#include "cli/terminal/line_mode.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/words.hpp"

namespace servoctl::cli {
namespace {

/// How often what stands in the prompt is looked at, and whose the terminal is.
constexpr Duration kLook = std::chrono::seconds(1);
/// Of xterm, DECSET 2004: what is pasted stands between marks.
constexpr std::string_view kMarkPastes = "\x1B[?2004h";
constexpr std::string_view kMarkNoPastes = "\x1B[?2004l";

/// Whether the terminal understands more than text.
bool moves_cursor() {
  const char* term = std::getenv("TERM");
  return term != nullptr && *term != '\0' && std::string_view(term) != "dumb";
}

bool shows_colours() {
  const char* none = std::getenv("NO_COLOR");
  return none == nullptr || *none == '\0';
}

/// Whether the line may have moved a motor.
bool may_move(const std::string& line) {
  const auto words = split_words(line);
  if (!words || words->empty()) return false;
  const auto match = match_command(*words);
  return is_batch(*words) || (match.command != nullptr && match.command->effect >= command::Effect::moves);
}

class Prompt {
 public:
  Prompt(Shell& shell, Console& console)
      : shell_(&shell),
        console_(&console),
        runner_(shell),
        editor_(history_,
                LineEditor::Host{
                    .size = [this] { return screen_size(); },
                    .offer = [this](std::string_view before) { return complete(before, *shell_); }}) {
    shell.stay_open(true);
    if (!folder_.empty()) history_.load(folder_ / "history");
  }
  Prompt(const Prompt&) = delete;
  Prompt& operator=(const Prompt&) = delete;
  ~Prompt() {
    rest();
    // What was typed is worth no word when it cannot be kept.
    if (!folder_.empty()) (void)history_.save(folder_ / "history");
  }

  int run();

 private:
  Screen::Size screen_size() const { return {console_->width(), console_->height()}; }
  PromptText prompt() const;
  void begin_line();
  void rest();
  bool wait_for_key();
  void take_keys();
  bool key_waits() const;
  void look();
  void show_notices();
  void drop_line();
  void run_line();
  void keep_place();
  void draw();
  void say(std::string_view text);

  Shell* shell_;
  Console* console_;
  LineRunner runner_;
  LineHistory history_;
  LineEditor editor_;
  LineMode mode_{STDIN_FILENO};
  std::filesystem::path folder_ = state_folder();
  std::string kept_;  ///< The place that was.
  bool shows_output_ = ::isatty(STDOUT_FILENO) == 1;
  bool edits_ = shows_output_ && moves_cursor();  ///< Else the terminal edits the line, as far as it does.
  bool colours_ = shows_colours();
  bool editing_ = false;  ///< A line is being typed.
  bool done_ = false;
  bool gives_up_paste_ = false;
  std::chrono::steady_clock::time_point last_key_;
  bool held_ = false;  ///< A key waits, and the terminal takes nothing: what it shows would be lost.
};

/// Red where there are colours.
PromptText Prompt::prompt() const {
  auto out = prompt_text(*shell_);
  out.alarm = out.alarm && colours_;
  return out;
}

void Prompt::draw() {
  if (edits_) console_->draw(editor_.draw());
}

/// What is no result stays out of a file that takes the results.
void Prompt::say(std::string_view text) {
  if (shows_output_)
    console_->out(text);
  else
    console_->err(text);
}

void Prompt::begin_line() {
  editor_.set_prompt(prompt());
  editor_.begin();
  editing_ = true;
  if (!edits_) return say(editor_.prompt().text);
  mode_.enter();
  keep_last_words(kMarkNoPastes);
  console_->draw(kMarkPastes);
  draw();
}

/// The terminal as it was, for whoever uses it next.
void Prompt::rest() {
  if (editing_ && edits_) console_->draw(kMarkNoPastes);
  editing_ = false;
  keep_last_words("");
  mode_.leave();
}

/// Once it is somewhere else than when it was kept last.
void Prompt::keep_place() {
  const auto& now = shell_->defaults();
  const auto place = now.bus + "\n" + now.nodes + "\n" + now.drive;
  if (std::exchange(kept_, place) != place) keep_last_place(*shell_, folder_);
}

int Prompt::run() {
  keep_place();
  begin_line();
  while (!done_ && !terminated()) {
    if (interrupted()) drop_line();
    if (wait_for_key()) take_keys();
    if (!done_) look();
  }
  rest();
  shell_->let_go();
  return terminated() ? exit_code(Errc::interrupted) : 0;
}

/// True when a key waits; frames and timers of the bus are served meanwhile.
bool Prompt::wait_for_key() {
  pollfd wanted{STDIN_FILENO, POLLIN, 0};
  if (held_) wanted = {STDOUT_FILENO, POLLOUT, 0};
  const auto lost = [this](const Error& error) {
    if (edits_) console_->draw(editor_.wipe());
    shell_->report_error(error, false);
    draw();
  };
  if (!shell_->wait_for(wanted, kLook, lost)) return false;
  const bool key = wanted.revents != 0;
  pollfd terminal{STDOUT_FILENO, POLLOUT, 0};
  held_ = key && ::poll(&terminal, 1, 0) == 0;
  return key && !held_;
}

bool Prompt::key_waits() const {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  return ::poll(&input, 1, 0) > 0;
}

/// All that were typed, but for what comes behind Enter: that is for whoever asks next.
void Prompt::take_keys() {
  constexpr int kAtOnce = 4096;
  for (int i = 0; i < kAtOnce && !done_ && key_waits(); ++i) {
    char byte = 0;
    last_key_ = std::chrono::steady_clock::now();
    if (::read(STDIN_FILENO, &byte, 1) != 1) {
      done_ = !interrupted();
      break;
    }
    const auto step = editor_.take(byte);
    if (step == LineEditor::Step::end) {
      if (edits_) console_->draw(editor_.leave());
      done_ = true;
    }
    if (step == LineEditor::Step::line) return run_line();
  }
  if (done_) return;
  draw();
}

/// What has changed meanwhile.
void Prompt::look() {
  // Ctrl-C may have dropped the end of a paste with the rest of it; what still comes is not taken for keys.
  const bool silent = std::chrono::steady_clock::now() - last_key_ > kLook;
  if (gives_up_paste_ && silent) {
    editor_.forget_key();
    gives_up_paste_ = false;
  }
  if (edits_ && mode_.renew()) {
    console_->draw(kMarkPastes);
    draw();
  }
  show_notices();
  if (const auto now = prompt(); edits_ && now != editor_.prompt()) {
    editor_.set_prompt(now);
    draw();
  }
}

void Prompt::show_notices() {
  const auto& settings = shell_->defaults();
  const auto loaded =
      settings.drive.empty() ? Result<const drive::Profile*>(nullptr) : shell_->profile(settings.drive);
  const auto notices = shell_->take_notices(loaded ? *loaded : nullptr, settings.chinese);
  if (notices.empty()) return;
  if (edits_) console_->draw(editor_.wipe());
  for (const auto& notice : notices) say("* " + printable(console_->in_language(notice)) + "\n");
  draw();
}

void Prompt::drop_line() {
  clear_interrupt();
  if (edits_)
    console_->draw(editor_.leave("^C"));
  else
    say("^C\n");
  editor_.drop();
  gives_up_paste_ = editor_.is_inside_key();
  rest();
  begin_line();
}

void Prompt::run_line() {
  const auto text = editor_.text();
  if (edits_) console_->draw(editor_.leave());
  rest();
  if (text.find_first_not_of(' ') != std::string::npos) history_.add(text);
  runner_.run(text);
  // An Enter typed while a motor turned, or before the next pasted line was shown, starts nothing.
  if (editor_.waits_pasted() || may_move(text)) (void)::tcflush(STDIN_FILENO, TCIFLUSH);
  clear_interrupt();
  keep_place();
  done_ = runner_.wants_exit();
  if (!done_ && !terminated()) begin_line();
}

}  // namespace

int run_prompt(Shell& shell, Console& console) { return Prompt(shell, console).run(); }

}  // namespace servoctl::cli
