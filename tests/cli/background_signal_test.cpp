// A second Ctrl-C to a program that runs in the background of its terminal.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

#include "cli/terminal/signals.hpp"

namespace servoctl::cli {
namespace {

constexpr int kStopped = 200;

/// Gets two interrupts in a process group that the terminal does not belong to.
[[noreturn]] void be_interrupted_twice(int terminal) {
  ::setpgid(0, 0);
  ::signal(SIGTTOU, SIG_DFL);
  install_signal_handlers();
  termios mode{};
  ::tcgetattr(terminal, &mode);
  keep_terminal_mode(terminal, mode);
  ::raise(SIGINT);
  ::raise(SIGINT);
  ::_exit(1);
}

/// The exit code of such a process, in a session of its own on this terminal.
[[noreturn]] void run_in_background(const std::string& name) {
  ::setsid();
  const int terminal = ::open(name.c_str(), O_RDWR | O_CLOEXEC);
  const auto child = ::fork();
  if (child == 0) be_interrupted_twice(terminal);
  ::setpgid(child, child);
  int status = 0;
  ::waitpid(child, &status, WUNTRACED);
  if (WIFSTOPPED(status)) ::kill(child, SIGKILL);
  ::_exit(WIFSTOPPED(status) ? kStopped : WEXITSTATUS(status));
}

TEST(BackgroundSignal, ASecondInterruptEndsAndDoesNotStop) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master < 0) GTEST_SKIP() << "there are no pseudo-terminals here";
  ASSERT_EQ(::grantpt(master), 0);
  ASSERT_EQ(::unlockpt(master), 0);
  const std::string name = ::ptsname(master);
  const auto leader = ::fork();
  if (leader == 0) run_in_background(name);
  int status = 0;
  ASSERT_EQ(::waitpid(leader, &status, 0), leader);
  ::close(master);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
}

}  // namespace
}  // namespace servoctl::cli
