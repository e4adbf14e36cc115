#include "cli/terminal/prompt.hpp"

#include <poll.h>
#include <unistd.h>

#include <fmt/format.h>
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/printable.hpp"
#include "base/timespec.hpp"
#include "cli/last_place.hpp"
#include "cli/line_runner.hpp"
#include "cli/terminal/completer.hpp"
#include "cli/terminal/line_editor.hpp"
#include "cli/terminal/pager.hpp"
#include "cli/terminal/prompt_notices.hpp"
#include "cli/terminal/prompt_terminal.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/terminal/typed_keys.hpp"
#include "cli/terminal/window_reader.hpp"

namespace servoctl::cli {
namespace {

/// How often what stands in the prompt is looked at, and whose the terminal is.
constexpr Duration kLook = std::chrono::seconds(1);
constexpr std::string_view kDropped =
    "what was typed meanwhile was dropped: nothing starts by itself behind a line that may move a motor";
/// Bytes of a paste that nothing marks; what is beyond is dropped.
constexpr std::size_t kMostPasted = 1U << 16U;

class Prompt {
 public:
  Prompt(Shell& shell, Console& console, bool by_windows)
      : shell_(&shell),
        console_(&console),
        runner_(shell, [this](const Outcome& outcome, const auto& words) { return show(outcome, words); }),
        by_windows_(by_windows),
        editor_(history_,
                LineEditor::Host{
                    .size =
                        [this] {
                          return Screen::Size{console_->width(), console_->height()};
                        },
                    .offer = [this](std::string_view before) { return complete(before, *shell_); },
                    .in_language = [this](std::string_view text) { return console_->in_language(text); },
                    .is_ascii = [this] { return console_->is_ascii(); }}),
        terminal_(console) {
    shell.stay_open(true);
    shell.disable_at_end();
    if (!folder_.empty()) history_.load(folder_ / "history");
  }
  Prompt(const Prompt&) = delete;
  Prompt& operator=(const Prompt&) = delete;
  ~Prompt() {
    terminal_.leave();
    // What was typed is worth no word when it cannot be kept.
    if (!folder_.empty()) (void)history_.save(folder_ / "history");
  }

  int run();

 private:
  void begin_line(bool moved = false);
  bool wait_for_key();
  void take_keys();
  bool more_comes();
  void hold_lines();
  void look();
  void show_notices();
  void drop_line();
  void run_line();
  int show(const Outcome& outcome, const std::vector<std::string>& words);
  void read_by_windows(const std::string& text);
  void keep_place();
  void wipe();
  void draw();
  bool wait_for(pollfd& wanted, Duration longest);

  Shell* shell_;
  Console* console_;
  LineRunner runner_;
  bool by_windows_;
  LineHistory history_;
  LineEditor editor_;
  PromptTerminal terminal_;
  TypedKeys keys_{STDIN_FILENO};
  std::filesystem::path folder_ = shell_->state_folder();
  std::string kept_;  ///< The place that was.
  bool done_ = false;
  bool gives_up_paste_ = false;
  bool held_ = false;   ///< A key waits, and the terminal takes nothing: what it shows would be lost.
  bool stale_ = false;  ///< What is on the screen is not what was typed.
  bool reads_ = false;  ///< A long answer is on the screen, and no line.
  PromptNotices notices_;
};

void Prompt::wipe() {
  if (terminal_.edits() && !reads_) terminal_.draw(editor_.wipe());
}

void Prompt::draw() {
  if (!terminal_.edits() || reads_) return;
  stale_ = terminal_.is_behind();
  if (!stale_) terminal_.draw(editor_.draw());
}

/// `moved`: behind a line that may have moved a motor.
void Prompt::begin_line(bool moved) {
  const bool waits = editor_.waits_pasted();
  editor_.set_prompt(dressed_prompt(*shell_, *console_));
  editor_.begin();
  terminal_.begin();
  // An Enter typed while a motor turned, or before the next line that waits is shown, starts nothing. Of
  // lines that are not whole nothing was known before.
  if ((moved || waits) && keys_.drop() > 0 && moved)
    terminal_.say("* " + console_->in_language(kDropped) + "\n");
  if (terminal_.edits()) return draw();
  const auto note = editor_.waiting_note();
  terminal_.say((note.empty() ? "" : note + "\n") + editor_.prompt().text + editor_.text());
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
  shell_->let_go();
  terminal_.leave();
  return terminated() ? exit_code(Errc::interrupted) : 0;
}

/// True when it is there; frames and timers of the bus are served meanwhile.
bool Prompt::wait_for(pollfd& wanted, Duration longest) {
  const auto lost = [this](const Error& error) {
    wipe();
    shell_->report_error(error, false);
    draw();
  };
  return shell_->wait_for(wanted, longest, lost) && wanted.revents != 0;
}

/// True when a key waits, and the terminal can show what comes of it.
bool Prompt::wait_for_key() {
  const bool waits = held_ || terminal_.is_behind();
  auto wanted = waits ? terminal_.room() : pollfd{STDIN_FILENO, POLLIN, 0};
  const bool there = wait_for(wanted, kLook);
  if (waits) {
    held_ = held_ && !there;
    if (!terminal_.is_behind() && stale_) draw();
    return false;
  }
  auto room = terminal_.room();
  held_ = there && ::poll(&room, 1, 0) == 0;
  return there && !held_;
}

/// All that were typed, but for what comes behind Enter: that is for whoever asks next.
void Prompt::take_keys() {
  constexpr int kAtOnce = 4096;
  for (int i = 0; i < kAtOnce && !done_ && keys_.wait(); ++i) {
    const auto byte = keys_.take();
    if (!byte) {
      done_ = !interrupted();
      break;
    }
    const auto step = editor_.take(*byte);
    if (step == LineEditor::Step::end) {
      if (terminal_.edits()) terminal_.draw(editor_.leave());
      done_ = true;
    }
    if (step != LineEditor::Step::line) continue;
    if (!more_comes()) return run_line();
    hold_lines();
  }
  if (!done_) draw();
}

/// Whether something comes behind what was read, faster than anyone types.
bool Prompt::more_comes() {
  if (!keys_.is_burst()) return keys_.wait();
  const auto end = steady_now() + TypedKeys::kPasteGoesOn;
  while (!keys_.wait() && !interrupted() && steady_now() < end) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    (void)wait_for(input, left_until(end));
  }
  return keys_.wait() && !interrupted();
}

/// Several lines at once are a paste, or were typed while another line ran: none of them runs by itself.
void Prompt::hold_lines() {
  for (std::size_t count = 0; more_comes();) {
    const auto byte = keys_.take();
    if (!byte) break;
    if (++count < kMostPasted) editor_.take_behind(*byte);
  }
  editor_.hold_behind();
  if (!terminal_.edits() && editor_.waits_pasted())
    terminal_.say(editor_.waiting_note() + "\n" + editor_.prompt().text + editor_.text());
}

/// What has changed meanwhile.
void Prompt::look() {
  // Ctrl-C may have dropped the end of a paste with the rest of it; what still comes is not taken for keys.
  const bool silent = std::chrono::steady_clock::now() - keys_.last() > kLook;
  if (gives_up_paste_ && silent) {
    editor_.forget_key();
    gives_up_paste_ = false;
  }
  const auto change = terminal_.take_change();
  if (change == PromptTerminal::Change::stopped) editor_.forget_screen();
  if (change != PromptTerminal::Change::none) draw();
  show_notices();
  if (const auto now = dressed_prompt(*shell_, *console_); terminal_.edits() && now != editor_.prompt()) {
    editor_.set_prompt(now);
    draw();
  }
}

void Prompt::show_notices() {
  notices_.hear(*shell_);
  if (notices_.empty() || terminal_.is_behind()) return;
  wipe();
  for (const auto& notice : notices_.give())
    terminal_.say("* " + printable(console_->in_language(notice.text())) + "\n");
  draw();
}

void Prompt::drop_line() {
  clear_interrupt();
  if (!terminal_.edits()) terminal_.say("^C\n");
  if (terminal_.edits()) terminal_.draw(editor_.leave("^C"));
  editor_.drop();
  gives_up_paste_ = editor_.is_inside_key();
  begin_line();
}

void Prompt::run_line() {
  const auto text = editor_.text();
  if (terminal_.edits()) terminal_.draw(editor_.leave());
  terminal_.pause();
  if (text.find_first_not_of(' ') != std::string::npos) history_.add(text);
  runner_.run(text);
  clear_interrupt();
  keep_place();
  done_ = runner_.wants_exit();
  if (done_ || terminated()) return;
  begin_line(may_move(text));
}

/// A long answer is read while the buses are served. What was typed ahead goes on with the next line: nothing
/// is asked then.
int Prompt::show(const Outcome& outcome, const std::vector<std::string>& words) {
  const auto& settings = outcome.settings;
  const bool holds = shell_->leaves_power() || shell_->must_go_on();
  const bool pages = by_windows_ && !refuses_pager(words) && !settings.json && !settings.quiet && !holds &&
                     !interrupted() && !keys_.wait();
  if (!pages) return cli::show(*console_, outcome);
  const auto text = text_of(outcome, console_->width());
  if (is_longer_than(text, console_->width(), console_->height()))
    read_by_windows(text);
  else
    console_->out(text);
  show_remarks(*console_, outcome);
  return outcome.code();
}

void Prompt::read_by_windows(const std::string& text) {
  reads_ = true;
  show_by_windows(*console_, text, [this] {
    pollfd key{STDIN_FILENO, POLLIN, 0};
    (void)wait_for(key, kLook);
    show_notices();
  });
  reads_ = false;
}

}  // namespace

int run_prompt(Shell& shell, Console& console, bool by_windows) {
  return Prompt(shell, console, by_windows).run();
}

}  // namespace servoctl::cli
