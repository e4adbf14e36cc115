#include "cli/terminal/live_output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "base/signal_wait.hpp"

namespace servoctl::cli {
namespace {

std::string line(int number) { return fmt::format("{:098}\n", number); }

std::string lines(int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += line(i);
  return out;
}

/// Where a text goes, and who reads it. One that waits after all is ended by the alarm.
class LiveOutputTest : public ::testing::Test {
 protected:
  LiveOutputTest() {
    ::alarm(20);
    std::signal(SIGPIPE, SIG_IGN);
  }
  ~LiveOutputTest() override {
    ::alarm(0);
    for (const int end : ends) ::close(end);
  }

  void make_pipe() {
    ASSERT_EQ(::pipe(ends.data()), 0);
    ASSERT_GE(::fcntl(ends[1], F_SETPIPE_SZ, 4096), 0);
  }
  /// What has arrived.
  std::string read_all() {
    ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
    std::string out;
    std::array<char, 4096> piece{};
    for (auto got = ::read(ends[0], piece.data(), piece.size()); got > 0;
         got = ::read(ends[0], piece.data(), piece.size()))
      out.append(piece.data(), static_cast<std::size_t>(got));
    return out;
  }

  std::array<int, 2> ends{-1, -1};  ///< Reader, writer.
};

TEST_F(LiveOutputTest, AReaderWhoDoesNotReadIsNotWaitedForAndLosesNothing) {
  make_pipe();
  LiveOutput output(ends[1]);
  output.open();
  for (int i = 0; i < 200; ++i) output.offer(line(i));
  EXPECT_EQ(output.take_left_out(), 0U);
  auto all = read_all();
  EXPECT_LE(all.size(), 4096U);
  output.offer(line(200));
  all += read_all() + output.take_waiting();
  EXPECT_EQ(all, lines(201));
}

TEST_F(LiveOutputTest, WhatIsTooMuchToKeepIsLeftOutInWholeLinesAndCounted) {
  make_pipe();
  LiveOutput output(ends[1]);
  output.open();
  for (int i = 0; i < 2000; ++i) output.offer(line(i));
  const auto left_out = output.take_left_out();
  EXPECT_GT(left_out, 1000U);
  EXPECT_EQ(output.take_left_out(), 0U);
  const auto all = read_all() + output.take_waiting();
  EXPECT_EQ(all, lines(2000 - static_cast<int>(left_out)));
}

TEST_F(LiveOutputTest, AReaderWhoTakesNothingIsWaitedForOnce) {
  make_pipe();
  LiveOutput output(ends[1]);
  output.open();
  const auto begin = steady_now();
  for (int i = 0; i < 200; ++i) output.offer(line(i), std::chrono::milliseconds(300));
  const auto waited = steady_now() - begin;
  EXPECT_GE(waited, std::chrono::milliseconds(300));
  EXPECT_LT(waited, std::chrono::seconds(3)) << "and not at every line";
  EXPECT_EQ(read_all() + output.take_waiting(), lines(200));
}

TEST_F(LiveOutputTest, WhatIsDueIsDoneWhileAReaderIsWaitedFor) {
  make_pipe();
  LiveOutput output(ends[1]);
  output.open();
  int pulses = 0;
  const auto pulse = [&]() -> Duration {
    ++pulses;
    return std::chrono::milliseconds(10);
  };
  const auto begin = steady_now();
  for (int i = 0; i < 200; ++i) output.offer(line(i), std::chrono::milliseconds(300), pulse);
  EXPECT_GE(steady_now() - begin, std::chrono::milliseconds(290));
  EXPECT_GE(pulses, 29);
  EXPECT_LT(pulses, 200) << "not at every line";
  EXPECT_EQ(read_all() + output.take_waiting(), lines(200));
}

TEST_F(LiveOutputTest, NobodyIsWaitedForWhereWhatIsDueCannotBeDone) {
  make_pipe();
  LiveOutput output(ends[1]);
  output.open();
  const auto begin = steady_now();
  for (int i = 0; i < 200; ++i)
    output.offer(line(i), std::chrono::seconds(5), [] { return Duration::zero(); });
  EXPECT_LT(steady_now() - begin, std::chrono::seconds(5));
  EXPECT_EQ(read_all() + output.take_waiting(), lines(200));
}

TEST_F(LiveOutputTest, ASignalEndsTheWait) {
  make_pipe();
  LiveOutput output(ends[1]);
  output.open();
  note_signal();
  const auto begin = steady_now();
  output.offer(lines(200), std::chrono::seconds(15));
  EXPECT_LT(steady_now() - begin, std::chrono::seconds(5));
  EXPECT_EQ(read_all() + output.take_waiting(), lines(200));
}

TEST_F(LiveOutputTest, OthersMayStillWaitAtTheSamePipe) {
  make_pipe();
  LiveOutput output(ends[1]);
  output.open();
  output.offer("a line\n");
  EXPECT_EQ(::fcntl(ends[1], F_GETFL) & O_NONBLOCK, 0);
}

TEST_F(LiveOutputTest, AReaderWhoHasGoneIsAnError) {
  make_pipe();
  LiveOutput output(ends[1]);
  output.open();
  ::close(ends[0]);
  output.offer("a line\n");
  EXPECT_EQ(output.error(), EPIPE);
}

TEST_F(LiveOutputTest, AReaderWhoHasGoneBeforeTheBeginningIsAnErrorToo) {
  make_pipe();
  ::close(ends[0]);
  LiveOutput output(ends[1]);
  output.open();
  output.offer("a line\n");
  EXPECT_EQ(output.error(), EPIPE);
}

TEST_F(LiveOutputTest, ASocketIsNotWaitedForEither) {
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  const int size = 4096;
  ASSERT_EQ(::setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &size, sizeof size), 0);
  LiveOutput output(ends[1]);
  output.open();
  for (int i = 0; i < 200; ++i) output.offer(line(i));
  const auto all = read_all() + output.take_waiting();
  EXPECT_EQ(all, lines(200));
}

TEST_F(LiveOutputTest, ATerminalHeldByCtrlSIsNotWaitedFor) {
  termios raw{};
  ::cfmakeraw(&raw);
  ASSERT_EQ(::openpty(&ends[0], &ends[1], nullptr, &raw, nullptr), 0);
  ASSERT_EQ(::tcflow(ends[1], TCOOFF), 0);
  LiveOutput output(ends[1]);
  output.open();
  for (int i = 0; i < 50; ++i) output.offer(line(i));
  EXPECT_EQ(read_all(), "");
  ASSERT_EQ(::tcflow(ends[1], TCOON), 0);
  output.offer(line(50));
  const auto all = read_all() + output.take_waiting();
  EXPECT_EQ(all, lines(51));
}

TEST_F(LiveOutputTest, AFileIsContinuedWhereItIs) {
  std::string name = "/tmp/live_output_XXXXXX";
  ends[1] = ::mkstemp(name.data());
  ASSERT_GE(ends[1], 0);
  ends[0] = ::open(name.c_str(), O_RDONLY);
  ::unlink(name.c_str());
  ASSERT_EQ(::write(ends[1], "before\n", 7), 7);
  LiveOutput output(ends[1]);
  output.open();
  output.offer("a line\n");
  EXPECT_EQ(read_all(), "before\na line\n");
}

}  // namespace
}  // namespace servoctl::cli
