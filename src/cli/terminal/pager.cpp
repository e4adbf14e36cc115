#include "cli/terminal/pager.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "cli/terminal/prompt_terminal.hpp"
#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

/// While it lives the keyboard is another's; the mode of the terminal is put back behind that.
class LentTerminal {
 public:
  LentTerminal() : has_mode_(::tcgetattr(STDIN_FILENO, &mode_) == 0) { lend_keyboard(true); }
  LentTerminal(const LentTerminal&) = delete;
  LentTerminal& operator=(const LentTerminal&) = delete;
  ~LentTerminal() {
    // From the background it would stop the process.
    if (has_mode_ && ::tcgetpgrp(STDIN_FILENO) == ::getpgrp())
      (void)::tcsetattr(STDIN_FILENO, TCSADRAIN, &mode_);
    lend_keyboard(false);
  }

 private:
  termios mode_{};
  bool has_mode_;
};

/// The environment of a pager: where the user says nothing else, less shows colours and UTF-8, leaves what it
/// has shown on the screen, and a text that fits at once.
class PagerEnvironment {
 public:
  PagerEnvironment() {
    for (char** one = environ; *one != nullptr; ++one) all_.push_back(*one);
    if (std::getenv("LESS") == nullptr) all_.push_back(options_.data());
    if (std::getenv("LESSCHARSET") == nullptr) all_.push_back(characters_.data());
    all_.push_back(nullptr);
  }
  char* const* data() { return all_.data(); }

 private:
  std::string options_ = "LESS=FRX";
  std::string characters_ = "LESSCHARSET=utf-8";
  std::vector<char*> all_;
};

/// The process; -1 where there is none.
pid_t start(std::string command, int input) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  ::posix_spawnattr_init(&attributes);
  // What servoctl ignores would be ignored there too.
  sigset_t usual;
  sigemptyset(&usual);
  for (const int signal : {SIGINT, SIGQUIT, SIGPIPE, SIGXFSZ}) sigaddset(&usual, signal);
  ::posix_spawnattr_setsigdefault(&attributes, &usual);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  std::string shell = "sh";
  std::string option = "-c";
  const std::array<char*, 4> words{shell.data(), option.data(), command.data(), nullptr};
  PagerEnvironment environment;
  pid_t out = -1;
  const int error = ::posix_spawn(&out, "/bin/sh", &actions, &attributes, words.data(), environment.data());
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  return error == 0 ? out : -1;
}

/// As much as the pager takes: one that was left has seen enough.
void feed(int pipe, std::string_view text) {
  while (!text.empty() && !terminated()) {
    const auto taken = ::write(pipe, text.data(), text.size());
    if (taken < 0 && errno != EINTR) return;
    if (taken > 0) text.remove_prefix(static_cast<std::size_t>(taken));
  }
}

/// How it ended, as waitpid() says it. What ends servoctl ends the pager.
int wait_for(pid_t pager) {
  int out = 0;
  bool told = false;
  while (::waitpid(pager, &out, 0) < 0) {
    if (errno != EINTR) return 0;
    if (terminated() && !std::exchange(told, true)) ::kill(pager, SIGTERM);
  }
  return out;
}

/// The shell says 126 and 127 where it cannot start it; less says 2 after Ctrl-C where that ends it, and more
/// than 128 is a signal.
bool has_failed(int status) {
  constexpr int kLeft = 2;
  constexpr int kSignal = 128;
  if (!WIFEXITED(status)) return false;
  const int code = WEXITSTATUS(status);
  return code != 0 && code != kLeft && code < kSignal;
}

/// What the user says of it; null for nothing.
const char* wanted_pager() {
  const char* own = std::getenv("SERVOCTL_PAGER");
  return own != nullptr ? own : std::getenv("PAGER");
}

}  // namespace

bool wants_pages() {
  const char* wanted = wanted_pager();
  if (!moves_cursor()) return false;
  const auto command = wanted == nullptr ? std::string_view("less") : trim(wanted);
  return !command.empty() && command != "cat";
}

std::string pager_command() {
  if (!wants_pages()) return {};
  const char* wanted = wanted_pager();
  if (wanted == nullptr) return is_in_path("less") ? "less -FRX" : "";
  return std::string(trim(wanted));
}

bool refuses_pager(const std::vector<std::string>& words) {
  const auto end = std::find(words.begin(), words.end(), "--");
  return std::find(words.begin(), end, "--no-pager") != end;
}

bool is_in_path(std::string_view program) {
  const char* path = std::getenv("PATH");
  const auto folders = split(path == nullptr ? std::string_view() : std::string_view(path), ':');
  return std::any_of(folders.begin(), folders.end(), [&](std::string_view folder) {
    return !folder.empty() && ::access((std::string(folder) + "/").append(program).c_str(), X_OK) == 0;
  });
}

bool is_longer_than(std::string_view text, std::size_t columns, std::size_t rows) {
  if (columns == 0 || rows == 0) return false;
  std::size_t needed = 1;
  while (!text.empty() && needed <= rows) {
    const auto end = std::min(text.find('\n'), text.size());
    needed += std::max<std::size_t>(1, (display_width(text.substr(0, end)) + columns - 1) / columns);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return needed > rows;
}

bool show_through(const std::string& command, std::string_view text) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return false;
  // Ignored, as some launchers leave it, it would keep from us how the pager ended.
  std::signal(SIGCHLD, SIG_DFL);
  const LentTerminal terminal;
  const auto pager = start(command, ends[0]);
  ::close(ends[0]);
  if (pager >= 0) feed(ends[1], text);
  ::close(ends[1]);
  return pager >= 0 && !has_failed(wait_for(pager));
}

}  // namespace servoctl::cli
