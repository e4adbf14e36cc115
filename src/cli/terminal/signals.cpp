#include "cli/terminal/signals.hpp"

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <initializer_list>
#include <utility>

#include "base/signal_wait.hpp"

namespace servoctl::cli {
namespace {

// A signal handler can reach nothing else.
volatile std::sig_atomic_t g_interrupted = 0;
volatile std::sig_atomic_t g_terminated = 0;
volatile std::sig_atomic_t g_protected = 0;
volatile std::sig_atomic_t g_has_timer = 0;
timer_t g_timer{};

using Handler = void (*)(int);

/// Ends blocking calls, and is ignored where nobody catches it.
constexpr int kNudge = SIGURG;
constexpr long kNudgeEvery = 100'000'000;  ///< Nanoseconds.

volatile std::sig_atomic_t g_has_mode = 0;
int g_terminal = -1;
termios g_mode{};
std::string_view g_last_words;
std::atomic<unsigned> g_resumed{0};
std::atomic<unsigned> g_signalled{0};

/// tcsetattr(), tcgetpgrp(), poll() and write() may be called by a handler. From the background it would stop
/// the process (SIGTTOU), and the terminal is another's. One that is held takes nothing.
void give_terminal_back() {
  if (g_has_mode != 0 && ::tcgetpgrp(g_terminal) != ::getpgrp()) return;
  if (g_has_mode != 0) (void)::tcsetattr(g_terminal, TCSANOW, &g_mode);
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  if (g_last_words.empty() || ::poll(&output, 1, 0) <= 0) return;
  (void)!::write(STDOUT_FILENO, g_last_words.data(), g_last_words.size());
}

bool is_of_keyboard(int signal) { return signal == SIGINT || signal == SIGQUIT; }

/// timer_settime() may be called by a handler.
void nudge(bool on) {
  if (g_has_timer == 0) return;
  itimerspec every{};
  if (on) every.it_value.tv_nsec = every.it_interval.tv_nsec = kNudgeEvery;
  ::timer_settime(g_timer, 0, &every, nullptr);
}

extern "C" void on_signal(int signal) {
  if (g_interrupted != 0 && is_of_keyboard(signal) && g_protected == 0) {
    give_terminal_back();
    ::_exit(130);
  }
  const int error = errno;
  g_interrupted = 1;
  g_signalled.fetch_add(1);
  if (signal != SIGINT && signal != SIGTSTP) g_terminated = 1;
  note_signal();
  nudge(true);
  errno = error;
}

extern "C" void on_nudge(int) {}

extern "C" void on_resize(int) { note_signal(); }

/// Ctrl-Z: the process stops here, and goes on here.
extern "C" void on_stop(int signal) {
  if (g_protected != 0) return on_signal(signal);
  const int error = errno;
  give_terminal_back();
  struct sigaction plain {};
  struct sigaction mine {};
  plain.sa_handler = SIG_DFL;
  sigemptyset(&plain.sa_mask);
  ::sigaction(SIGTSTP, &plain, &mine);
  ::raise(SIGTSTP);
  sigset_t stop;
  sigset_t before;
  sigemptyset(&stop);
  sigaddset(&stop, SIGTSTP);
  ::pthread_sigmask(SIG_UNBLOCK, &stop, &before);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::sigaction(SIGTSTP, &mine, nullptr);
  g_resumed.fetch_add(1);
  // Whoever waits for a key shows what was there before.
  if (g_has_mode != 0) note_signal();
  errno = error;
}

/// While it lives no signal comes.
class Quiet {
 public:
  Quiet() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

/// What was set before.
struct sigaction set_handler(int signal, Handler handler) {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, &before);
  return before;
}

/// A profiler's own timer stays, and what whoever started us wants ignored. While it is set all signals are
/// held.
void catch_if_deadly(int signal) {
  const auto before = set_handler(signal, on_signal);
  if (before.sa_handler != SIG_DFL) sigaction(signal, &before, nullptr);
}

/// A call that is entered just after a signal would block in spite of it.
void make_timer() {
  set_handler(kNudge, on_nudge);
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = kNudge;
  g_has_timer = ::timer_create(CLOCK_MONOTONIC, &event, &g_timer) == 0 ? 1 : 0;
}

}  // namespace

void install_signal_handlers() {
  const Quiet quiet;
  make_timer();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) set_handler(signal, on_signal);
  for (const int signal :
       {SIGQUIT, SIGABRT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU, SIGIO, SIGPWR, SIGSTKFLT})
    catch_if_deadly(signal);
  // The write fails instead, and is told.
  for (const int signal : {SIGPIPE, SIGXFSZ}) set_handler(signal, SIG_IGN);
}

void lend_keyboard(bool lent) {
  static struct sigaction interrupt, quit;  // As they were before.
  const Quiet quiet;
  if (lent) {
    interrupt = set_handler(SIGINT, SIG_IGN);
    quit = set_handler(SIGQUIT, SIG_IGN);
    return;
  }
  sigaction(SIGINT, &interrupt, nullptr);
  sigaction(SIGQUIT, &quit, nullptr);
}

void keep_terminal_mode(int descriptor, const termios& before) {
  const Quiet quiet;
  g_terminal = descriptor;
  g_mode = before;
  g_has_mode = 1;
  if (const auto found = set_handler(SIGTSTP, on_stop); found.sa_handler == SIG_IGN)
    sigaction(SIGTSTP, &found, nullptr);
}

void forget_terminal_mode() {
  const Quiet quiet;
  g_has_mode = 0;
}

std::string_view keep_last_words(std::string_view words) {
  const Quiet quiet;
  return std::exchange(g_last_words, words);
}

void note_resizes(bool notes) {
  const Quiet quiet;
  set_handler(SIGWINCH, notes ? on_resize : SIG_DFL);
}

unsigned times_resumed() { return g_resumed.load(); }

void protect_from_signals(bool energised) {
  static struct sigaction stop, input, output;  // As they were before.
  static bool catches_all = false;
  const Quiet quiet;
  if (energised == (g_protected != 0)) return;
  g_protected = energised ? 1 : 0;
  if (energised) {
    // Thirty calls that a one-shot read can do without: nothing but a person's own `kill` sends these.
    if (!catches_all)
      for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) catch_if_deadly(signal);
    catches_all = true;
    stop = set_handler(SIGTSTP, on_signal);
    input = set_handler(SIGTTIN, SIG_IGN);
    output = set_handler(SIGTTOU, SIG_IGN);
    return;
  }
  sigaction(SIGTSTP, &stop, nullptr);
  sigaction(SIGTTIN, &input, nullptr);
  sigaction(SIGTTOU, &output, nullptr);
}

unsigned times_signalled() { return g_signalled.load(); }
bool interrupted() { return g_interrupted != 0; }
bool terminated() { return g_terminated != 0; }

void clear_interrupt() {
  const Quiet quiet;
  g_interrupted = 0;
  if (g_terminated == 0) nudge(false);
}

}  // namespace servoctl::cli
