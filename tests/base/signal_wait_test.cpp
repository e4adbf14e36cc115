#include "base/signal_wait.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>

namespace servoctl {
namespace {

using namespace std::chrono_literals;

extern "C" void note(int) { note_signal(); }

class SignalWait : public testing::Test {
 protected:
  SignalWait() {
    struct sigaction action {};
    action.sa_handler = note;
    sigaction(SIGUSR2, &action, &before_);
    while (wait_or_signal({}, 0us) < 0) {
    }
  }
  ~SignalWait() override { sigaction(SIGUSR2, &before_, nullptr); }

 private:
  struct sigaction before_ {};
};

TEST_F(SignalWait, EndsAtOnceForASignalThatCameBeforeIt) {
  ::raise(SIGUSR2);
  const auto begin = steady_now();
  EXPECT_EQ(wait_or_signal({}, 60s), -1);
  EXPECT_EQ(errno, EINTR);
  EXPECT_LT(steady_now() - begin, 30s);
}

TEST_F(SignalWait, ASignalEndsOneWaitOnly) {
  ::raise(SIGUSR2);
  ::raise(SIGUSR2);
  EXPECT_EQ(wait_or_signal({}, 1us), -1);
  EXPECT_EQ(wait_or_signal({}, 1us), 0);
}

TEST_F(SignalWait, ABlockedSignalComesAfterwards) {
  sigset_t set;
  sigset_t before;
  sigemptyset(&set);
  sigaddset(&set, SIGUSR2);
  pthread_sigmask(SIG_BLOCK, &set, &before);
  ::raise(SIGUSR2);
  EXPECT_EQ(wait_or_signal({}, 1us), 0) << "the mask of the process holds while it waits";
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_EQ(wait_or_signal({}, 1us), -1);
}

}  // namespace
}  // namespace servoctl
