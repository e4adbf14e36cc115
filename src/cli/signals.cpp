#include "cli/signals.hpp"

#include <unistd.h>
#include <csignal>
#include <initializer_list>

namespace servoctl::cli {
namespace {

// A signal handler can reach nothing else.
volatile std::sig_atomic_t g_interrupted = 0;
volatile std::sig_atomic_t g_terminated = 0;
volatile std::sig_atomic_t g_protected = 0;

using Handler = void (*)(int);

bool is_of_keyboard(int signal) { return signal == SIGINT || signal == SIGQUIT; }

extern "C" void on_signal(int signal) {
  if (g_interrupted != 0 && is_of_keyboard(signal) && g_protected == 0) ::_exit(130);
  g_interrupted = 1;
  if (signal != SIGINT && signal != SIGTSTP) g_terminated = 1;
}

/// What was set before.
struct sigaction set_handler(int signal, Handler handler) {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, &before);
  return before;
}

/// A profiler's own timer stays, and what whoever started us wants ignored.
void catch_if_deadly(int signal) {
  struct sigaction now {};
  if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) set_handler(signal, on_signal);
}

}  // namespace

void install_signal_handlers() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) set_handler(signal, on_signal);
  for (const int signal :
       {SIGQUIT, SIGABRT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU, SIGIO, SIGPWR, SIGSTKFLT})
    catch_if_deadly(signal);
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) catch_if_deadly(signal);
  // The write fails instead, and is told.
  for (const int signal : {SIGPIPE, SIGXFSZ}) set_handler(signal, SIG_IGN);
}

void protect_from_signals(bool energised) {
  static struct sigaction stop, input, output;  // As they were before.
  if (energised == (g_protected != 0)) return;
  if (energised) {
    g_protected = 1;
    stop = set_handler(SIGTSTP, on_signal);
    input = set_handler(SIGTTIN, SIG_IGN);
    output = set_handler(SIGTTOU, SIG_IGN);
    return;
  }
  sigaction(SIGTSTP, &stop, nullptr);
  sigaction(SIGTTIN, &input, nullptr);
  sigaction(SIGTTOU, &output, nullptr);
  g_protected = 0;
}

bool interrupted() { return g_interrupted != 0; }
bool terminated() { return g_terminated != 0; }
void clear_interrupt() { g_interrupted = 0; }

}  // namespace servoctl::cli
