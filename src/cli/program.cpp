#include "cli/program.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <span>

#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/standard_input.hpp"
#include "base/version.hpp"
#include "cli/batch/batch_command.hpp"
#include "cli/batch/input_lines.hpp"
#include "cli/last_place.hpp"
#include "cli/line_runner.hpp"
#include "cli/outcome.hpp"
#include "cli/parse.hpp"
#include "cli/shell.hpp"
#include "cli/state_folder.hpp"
#include "cli/tab_answer.hpp"
#include "cli/terminal/ascii_form.hpp"
#include "cli/terminal/console.hpp"
#include "cli/terminal/pager.hpp"
#include "cli/terminal/prompt.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "cli/terminal/signals.hpp"
#include "cli/words.hpp"
#include "show/output_file.hpp"

namespace servoctl::cli {
namespace {

constexpr std::string_view kManual = "man";
constexpr std::string_view kPagerFailed =
    "the pager failed: this is the text as it is; SERVOCTL_PAGER names another";

/// A standard stream that was closed would be the next thing that is opened: text for people would go into
/// the socket of the bus.
void open_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest that is free, which is this one.
    const int direction = descriptor == STDIN_FILENO ? O_RDONLY : O_WRONLY;
    if (::open("/dev/null", direction) != descriptor) ::_exit(exit_code(Errc::file));
  }
}

/// Whether the line reads what else the input has: then it is the last one.
bool takes_rest(const std::string& line) {
  const auto words = split_words(line);
  return words && std::find(words->begin(), words->end(), "-") != words->end();
}

/// For who starts without a bus.
void tell_first_steps(Console& console) {
  for (const auto* line :
       {"`bus detect` looks for adapters and their bitrate; `bus can0` opens an interface",
        "`scan` shows the drives, `use 1` chooses one, `status` shows its state",
        "without a drive: `bus sim:FAMILY@1` simulates one (`drives` lists them); `help` lists all commands"})
    console.note(console.in_language(line) + "\n");
}

bool needs_first_steps(Shell& shell) {
  return shell.defaults().bus.empty() && shell.defaults().nodes.empty();
}

/// Lines from a pipe or file: stops at the first that fails, whose exit code is the answer. What a line
/// begins goes on behind it, as at the prompt, and ends with the input.
int run_pipe(Shell& shell) {
  auto& input = standard_input();
  shell.end_interrupted_by_signal();
  LineRunner runner(shell);
  std::string line;
  int code = 0;
  bool any = false;
  while (code == 0 && !runner.wants_exit() && next_line(shell, input, line)) {
    any = true;
    shell.stay_open(!takes_rest(line));
    code = runner.run(line);
  }
  if (code == 0 && interrupted()) code = exit_code(Errc::interrupted);
  if (!any && code == 0 && needs_first_steps(shell)) tell_first_steps(shell.console());
  if (code != 0) shell.let_go();
  shell.stop_sync();
  return code;
}

/// Options without a command hold for all lines that follow. They are read as those of the command that needs
/// nothing else.
Result<Settings> settings_for_lines(Shell& shell, std::vector<std::string> words) {
  if (const auto known = check_options_alone(words); !known) return fail(known.error());
  words.emplace_back("help");
  const auto parsed = parse_line(words);
  if (!parsed) return fail(parsed.error());
  auto applied = apply_options(shell.defaults(), parsed->arguments);
  if (!applied) return applied;
  shell.console().set_chinese(applied->chinese);
  shell.console().set_quiet(applied->quiet);
  return shell.settings_for_lines(std::move(*applied));
}

/// The trace of all lines.
Result<void> may_trace(Shell& shell) {
  command::Context context;
  const RunningLine line(shell, shell.defaults(), context);
  return show::may_replace(shell.defaults().trace, shell.defaults().read_only, context);
}

/// `servoctl -` is `servoctl run -`.
std::vector<std::string> as_run(std::vector<std::string> words, std::size_t at) {
  words.insert(words.begin() + static_cast<std::ptrdiff_t>(at), "run");
  return words;
}

std::string standard_text() { return standard_input().take_rest(); }

/// Whether the line has a result that is whole, for a person at a terminal, and no drive waits for them.
bool may_page(Shell& shell, const Outcome& outcome, const std::vector<std::string>& words,
              const StandardConsole& console) {
  const bool unwanted = refuses_pager(words) || interrupted();
  const bool is_whole = !outcome.settings.json && !console.has_shown();
  const bool holds = shell.leaves_power() || shell.must_go_on();
  return !unwanted && is_whole && !holds && console.height() > 0 && ::isatty(STDIN_FILENO) == 1;
}

/// What shows the outcome a window at a time; empty where that is not wanted.
std::string pager_for(const Outcome& outcome) {
  auto pager = pager_command();
  const bool is_manual = outcome.command == kManual && !pager.empty() && is_in_path("man");
  return is_manual ? "man -l -" : pager;
}

/// A line that nothing follows. What is longer than the window goes to a pager, which may be read for an
/// hour: no bus is open then.
int run_one(Shell& shell, const std::vector<std::string>& words, StandardConsole& console) {
  const auto outcome = shell.perform(words);
  const auto text =
      may_page(shell, outcome, words, console) ? text_of(outcome, console.width()) : std::string();
  const bool is_long = is_longer_than(text, console.width(), console.height());
  const auto pager = is_long ? pager_for(outcome) : std::string();
  if (pager.empty()) {
    const int code = show(console, outcome);
    return code == 0 ? shell.hold() : code;
  }
  const int code = shell.close(outcome.code());
  if (!show_through(pager, console.as_written(text))) {
    console.note(formatted("notice: {}\n", kPagerFailed));
    console.out(text);
  }
  show_remarks(console, outcome);
  return code;
}

int run_lines(Shell& shell, const std::vector<std::string>& words, StandardConsole& console) {
  const auto first = match_command(words).first;
  console.set_chinese(wants_chinese(words, shell.defaults().chinese));
  console.set_ascii(locale_is_not_utf8());
  const bool is_run_of_input = first < words.size() && words[first] == "-";
  if (is_run_of_input || is_batch(words)) {
    shell.end_interrupted_by_signal();
    return run_batch(shell, is_run_of_input ? as_run(words, first) : words, standard_text);
  }
  if (first < words.size() || asks_for_help(words)) return run_one(shell, words, console);
  auto settings = settings_for_lines(shell, words);
  if (!settings) return shell.report_error(settings.error(), false);
  const bool traces = settings->trace != shell.defaults().trace;
  shell.defaults() = std::move(*settings);
  if (const auto may = traces ? may_trace(shell) : Result<void>(); !may)
    return shell.report_error(may.error(), false);
  console.set_colour(shell.defaults().colour);
  if (::isatty(STDIN_FILENO) != 1) return run_pipe(shell);
  if (shell.defaults().bus.empty()) {
    if (!take_last_place(shell, shell.state_folder()) && needs_first_steps(shell)) tell_first_steps(console);
  } else if (const auto opened = open_chosen_bus(shell, shell.defaults()); !opened) {
    return shell.report_error(opened.error(), false);
  }
  return run_prompt(shell, console, !refuses_pager(words) && wants_pages());
}

/// For the completion script of a shell. Any signal ends it.
int run_tab(const std::vector<std::string>& words, StandardConsole& console) {
  // What is named as a file may be a pipe into which nobody writes.
  constexpr unsigned kLongestWaitSeconds = 2;
  ::alarm(kLongestWaitSeconds);
  Shell::Options options;
  options.defaults = settings_from_environment();
  options.state_folder = state_folder_as_it_is().path;
  Shell shell(console, std::move(options));
  const auto answer = answer_tab(std::span(words).subspan(1), shell);
  if (!answer.empty()) console.out(answer + "\n");
  return 0;
}

/// Whether the line, or those that follow, may reach a drive, and notices are wanted: then it is told that
/// nothing is remembered.
bool wants_state(const std::vector<std::string>& words) {
  const auto match = match_command(words);
  const bool without =
      match.command != nullptr && !is_batch(words) && !includes(match.command->needs, command::Needs::bus);
  const auto says = [&](std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  return !without && !asks_for_help(words) && !says("-q") && !says("--quiet");
}

/// To stderr, if that takes it: how the program ends does not depend on whether anybody can read why.
void say(std::string_view text) noexcept {
  while (!text.empty()) {
    const auto taken = ::write(STDERR_FILENO, text.data(), text.size());
    if (taken < 0 && errno == EINTR && !interrupted()) continue;
    if (taken <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(taken));
  }
}

void say_bug(std::string_view what) noexcept {
  try {
    say(formatted(
        "error: servoctl failed: {}\n  hint: this is a bug; please report it with the command line\n",
        printable(what)));
  } catch (...) {
    say(what);  // Memory may be what is missing.
  }
}

int run(const std::vector<std::string>& words, StandardConsole& console) {
  if (!words.empty() && words.front() == kTabQuestion) return run_tab(words, console);
  Shell::Options options;
  options.defaults = settings_from_environment();
  auto state = state_folder();
  options.state_folder = std::move(state.path);
  options.cancelled = interrupted;
  Shell shell(console, std::move(options));
  if (words.size() == 1 && words.front() == "--version") {
    console.out(formatted("servoctl {}\n", version()));
    return 0;
  }
  if (wants_state(words) && !state.why_not.empty())
    console.note(formatted("notice: {}\n", printable(console.in_language(state.why_not))));
  install_signal_handlers();
  try {
    return shell.close(run_lines(shell, words, console));
  } catch (...) {
    // Memory that ran out, or a bug: what is energised is not left to itself.
    shell.let_go();
    (void)shell.close(exit_code(Errc::bug));
    throw;
  }
}

}  // namespace

int run_program(const std::vector<std::string>& words) {
  try {
    open_standard_descriptors();
    StandardConsole console;
    const int code = run(words, console);
    console.finish();
    // A reader that has closed the pipe has seen enough.
    if (console.write_error() == 0 || console.write_error() == EPIPE) return code;
    say(
        formatted("error: cannot write the output ({}); the output is incomplete\n"
                  "  hint: what the command did on the bus stays done\n",
                  std::strerror(console.write_error())));
    return code != 0 ? code : exit_code(Errc::file);
  } catch (const std::exception& e) {
    say_bug(e.what());
  } catch (...) {
    say_bug("?");
  }
  return exit_code(Errc::bug);
}

}  // namespace servoctl::cli
