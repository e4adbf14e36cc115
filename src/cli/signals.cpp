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

extern "C" void on_signal(int signal) {
  if (g_interrupted != 0 && signal == SIGINT && g_protected == 0) ::_exit(130);
  g_interrupted = 1;
  if (signal != SIGINT) g_terminated = 1;
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  struct sigaction ignore {};
  ignore.sa_handler = SIG_IGN;
  sigemptyset(&ignore.sa_mask);
  sigaction(SIGPIPE, &ignore, nullptr);
}

void protect_from_signals(bool energised) { g_protected = energised ? 1 : 0; }

bool interrupted() { return g_interrupted != 0; }
bool terminated() { return g_terminated != 0; }
void clear_interrupt() { g_interrupted = 0; }

}  // namespace servoctl::cli
