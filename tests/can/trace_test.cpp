
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/can/trace_fixture.hpp"

namespace servoctl::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

Frame parsed(const char* text) { return parse_frame(text).value(); }

constexpr TimePoint kStart{microseconds(1'736'412'345'123'456)};

TEST_F(Trace, HasALineForEveryFrameSentAndReceived) {
  auto bus = trace(kStart);
  inner_->coming.emplace_back(kStart + microseconds(900), parsed("581#4341600037020000"));
  inner_->coming.emplace_back(kStart + seconds(1), parsed("20000040#0000000000000000"));
  ASSERT_TRUE(bus->send(parsed("601#4041600000000000")));
  EXPECT_EQ(bus->receive(kStart + seconds(2)).value(), parsed("581#4341600037020000"));
  EXPECT_EQ(bus->receive(kStart + seconds(2)).value(), parsed("20000040#0000000000000000"));
  ASSERT_TRUE(bus->send(parsed("701#R")));
  ASSERT_TRUE(bus->send(parsed("00000123#")));
  bus->end_trace();
  EXPECT_EQ(written(),
            "(1736412345.123456) can0 601#4041600000000000\n"
            "(1736412345.124356) can0 581#4341600037020000\n"
            "(1736412346.123456) can0 20000040#0000000000000000\n"
            "(1736412346.123456) can0 701#R\n"
            "(1736412346.123456) can0 00000123#\n");
}

TEST_F(Trace, OfASimulatedBusCountsFromItsZero) {
  auto bus = trace(TimePoint{});
  ASSERT_TRUE(bus->send(parsed("000#8100")));
  bus->end_trace();
  EXPECT_EQ(written(), "(0000000000.000000) can0 000#8100\n");
}

TEST_F(Trace, OfARealBusShowsTheTimeOfDay) {
  auto bus = trace(TimePoint{seconds(3)}, TraceClock::wall);
  const auto before = std::chrono::system_clock::now().time_since_epoch();
  ASSERT_TRUE(bus->send(parsed("000#8100")));
  bus->end_trace();
  const auto line = parse_log_line(written());
  ASSERT_TRUE(line);
  EXPECT_LT(std::chrono::abs(line->time - before), seconds(60));
}

TEST_F(Trace, ReplacesAnOlderFile) {
  EXPECT_TRUE(trace(kStart)->send(parsed("080#0102")));
  EXPECT_TRUE(trace(kStart)->send(parsed("081#")));
  EXPECT_EQ(written(), "(1736412345.123456) can0 081#\n");
}

TEST_F(Trace, ReachesTheFileWithinATenthOfASecondOfWaiting) {
  const auto bus = trace(kStart);
  ASSERT_TRUE(bus->send(parsed("080#")));
  EXPECT_EQ(written(), "");
  EXPECT_EQ(bus->receive(kStart + milliseconds(99)).value(), std::nullopt);
  EXPECT_EQ(written(), "");
  inner_->coming.emplace_back(kStart + seconds(1), parsed("701#00"));
  EXPECT_EQ(bus->receive(kStart + seconds(5)).value(), parsed("701#00"));
  EXPECT_EQ(written(), "(1736412345.123456) can0 080#\n");
  const std::vector waits{kStart + milliseconds(99), kStart + milliseconds(100), kStart + seconds(5)};
  EXPECT_EQ(inner_->deadlines, waits);
}

TEST_F(Trace, ReachesTheFileWhileFramesKeepComing) {
  const auto bus = trace(kStart);
  for (int i = 0; i < 3; ++i) inner_->coming.emplace_back(kStart + milliseconds(60 * i), parsed("181#00"));
  for (int i = 0; i < 3; ++i) ASSERT_EQ(bus->receive(kStart + seconds(5)).value(), parsed("181#00"));
  EXPECT_EQ(lines(), 2);
}

TEST_F(Trace, ReachesTheFileWhileFramesAreSentWithoutWaiting) {
  const auto bus = trace(kStart);
  ASSERT_TRUE(bus->send(parsed("080#")));
  ASSERT_TRUE(inner_->receive(kStart + milliseconds(100)));
  ASSERT_TRUE(bus->send(parsed("080#")));
  EXPECT_EQ(lines(), 2);
}

TEST_F(Trace, DoesNotChangeWhatReceiveReturnsOrWhen) {
  const auto bus = trace(kStart);
  ASSERT_TRUE(bus->send(parsed("080#")));
  EXPECT_EQ(bus->receive(kStart + seconds(5)).value(), std::nullopt);
  EXPECT_EQ(bus->now(), kStart + seconds(5));
  ASSERT_TRUE(bus->send(parsed("080#")));
  inner_->interrupted = true;
  inner_->deadlines.clear();
  EXPECT_EQ(bus->receive(kStart + seconds(9)).value(), std::nullopt);
  EXPECT_EQ(inner_->deadlines.size(), 1U);
  EXPECT_EQ(bus->now(), kStart + seconds(5));
}

TEST_F(Trace, TellsAPollLoopWhenItWantsToBeWritten) {
  const auto bus = trace(kStart);
  EXPECT_EQ(bus->poll_fd(), 77);
  EXPECT_EQ(bus->next_event(), kNever);
  ASSERT_TRUE(bus->send(parsed("080#")));
  EXPECT_EQ(bus->next_event(), kStart + milliseconds(100));
  inner_->next = kStart + milliseconds(10);
  EXPECT_EQ(bus->next_event(), kStart + milliseconds(10));
}

TEST_F(Trace, IsCompleteWhenTheBusFails) {
  const auto bus = trace(kStart);
  ASSERT_TRUE(bus->send(parsed("080#")));
  inner_->broken = true;
  EXPECT_EQ(bus->send(parsed("081#")).error().code, Errc::bus);
  EXPECT_EQ(written(), "(1736412345.123456) can0 080#\n");
  inner_->broken = false;
  ASSERT_TRUE(bus->send(parsed("082#")));
  inner_->broken = true;
  EXPECT_EQ(bus->receive(kStart + seconds(1)).error().code, Errc::bus);
  EXPECT_EQ(lines(), 2);
}

TEST_F(Trace, ThatCannotBeWrittenSaysSoOnceAndLeavesTheBusUsable) {
  auto inner = std::make_unique<ScriptedBus>(kStart);
  std::vector<Error> told;
  auto bus = trace_to(std::move(inner), "/dev/full", "can0", TraceClock::bus, [&](const Error& error) {
               told.push_back(error);
             }).value();
  ASSERT_TRUE(bus->send(parsed("080#")));
  EXPECT_TRUE(bus->receive(kStart + milliseconds(200)));
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told.front().code, Errc::file);
  EXPECT_NE(told.front().message.text().find("/dev/full"), std::string::npos);
  for (int i = 3; i < 10; ++i) {
    EXPECT_TRUE(bus->send(parsed("080#")));
    EXPECT_TRUE(bus->receive(kStart + i * milliseconds(100)));
  }
  bus->end_trace();
  EXPECT_EQ(told.size(), 1U);
}

TEST_F(Trace, WhoseLastFramesCannotBeWrittenSaysSoAtItsEnd) {
  for (const bool flushed : {false, true}) {
    SCOPED_TRACE(flushed);
    std::vector<Error> told;
    auto bus = trace_to(std::make_unique<ScriptedBus>(kStart), "/dev/full", "can0", TraceClock::bus,
                        [&](const Error& error) { told.push_back(error); })
                   .value();
    ASSERT_TRUE(bus->send(parsed("080#")));
    EXPECT_TRUE(told.empty());
    if (flushed) bus->flush_trace();
    EXPECT_EQ(told.size(), flushed ? 1U : 0U);
    bus->end_trace();
    EXPECT_EQ(told.size(), 1U);
  }
}

/// A named pipe in place of the file, and who has it open for reading.
class TracePipe : public Trace {
 protected:
  TracePipe() {
    std::filesystem::remove(file_);
    EXPECT_EQ(::mkfifo(file_.c_str(), 0600), 0);
    ::alarm(20);  // Whoever waits after all is ended.
  }
  ~TracePipe() override {
    ::alarm(0);
    if (reader >= 0) ::close(reader);
  }
  void open_reader() {
    reader = ::open(file_.c_str(), O_RDONLY | O_NONBLOCK);
    ASSERT_GE(::fcntl(reader, F_SETPIPE_SZ, 4096), 0);
  }
  std::size_t read_lines() const {
    std::size_t lines = 0;
    std::array<char, 4096> piece{};
    for (auto got = ::read(reader, piece.data(), piece.size()); got > 0;
         got = ::read(reader, piece.data(), piece.size()))
      lines += static_cast<std::size_t>(std::count(piece.begin(), piece.begin() + got, '\n'));
    return lines;
  }
  int reader = -1;
};

TEST_F(TracePipe, ThatNobodyHasOpenedIsRefusedAtOnce) {
  const auto bus = trace_to(std::make_unique<ScriptedBus>(kStart), file_, "can0");
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().code, Errc::file);
  EXPECT_NE(bus.error().message.text().find("nobody reads"), std::string::npos) << bus.error().message.text();
}

TEST_F(TracePipe, ThatNobodyReadsHoldsNothingUpAndCountsWhatIsMissing) {
  open_reader();
  auto bus = trace(kStart);
  constexpr std::size_t kFrames = 50'000;
  for (std::size_t i = 0; i < kFrames; ++i) ASSERT_TRUE(bus->send(parsed("080#")));
  ASSERT_TRUE(bus->receive(kStart + seconds(1)));
  ASSERT_TRUE(bus->receive(bus->now()));
  EXPECT_GT(bus->next_event(), bus->now()) << "it is asked again later, not over and over";
  const auto told = bus->take_notices();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told.front().text().find("frames are missing in the trace"), std::string::npos)
      << told.front().text();
  EXPECT_TRUE(bus->take_notices().empty());
  const auto missing = std::stoul(told.front().text());
  auto lines = read_lines();
  for (auto time = kStart + seconds(2); time < kStart + seconds(100); time += milliseconds(150)) {
    ASSERT_TRUE(bus->receive(time));
    lines += read_lines();
  }
  EXPECT_EQ(lines + missing, kFrames) << "whole lines only";
}

TEST_F(TracePipe, IsNotWaitedForAtTheEndAndSaysWhatIsMissing) {
  open_reader();
  std::vector<Error> told;
  auto bus = trace_to(std::make_unique<ScriptedBus>(kStart), file_, "can0", TraceClock::bus,
                      [&](const Error& error) { told.push_back(error); })
                 .value();
  constexpr std::size_t kFrames = 1'000;
  for (std::size_t i = 0; i < kFrames; ++i) ASSERT_TRUE(bus->send(parsed("080#")));
  const auto begin = std::chrono::steady_clock::now();
  bus->end_trace();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, seconds(5));
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told.front().code, Errc::file);
  EXPECT_EQ(std::stoul(told.front().message.text()) + read_lines(), kFrames) << told.front().message.text();
}

TEST_F(TracePipe, ThatIsDestroyedTellsNobody) {
  open_reader();
  std::vector<Error> told;
  auto bus = trace_to(std::make_unique<ScriptedBus>(kStart), file_, "can0", TraceClock::bus,
                      [&](const Error& error) { told.push_back(error); })
                 .value();
  for (int i = 0; i < 1'000; ++i) ASSERT_TRUE(bus->send(parsed("080#")));
  bus.reset();
  EXPECT_TRUE(told.empty()) << "who is told may be gone already";
  EXPECT_GT(read_lines(), 0U) << "what is taken at once is written";
}

TEST_F(TracePipe, LeavesTheBusBeforeItWaitsForItsReader) {
  open_reader();
  bool left = false;
  bool left_when_told = false;
  auto inner = std::make_unique<ScriptedBus>(kStart);
  inner->left = &left;
  auto bus = trace_to(std::move(inner), file_, "can0", TraceClock::bus, [&](const Error&) {
               left_when_told = left;
             }).value();
  for (int i = 0; i < 1'000; ++i) ASSERT_TRUE(bus->send(parsed("080#")));
  bus->end_trace();
  EXPECT_TRUE(left_when_told) << "meanwhile nobody takes what others send to it";
}

TEST_F(Trace, IsRefusedWhenTheFileCannotBeMade) {
  const auto bus = trace_to(std::make_unique<ScriptedBus>(kStart), "/nosuchfolder/trace.log", "can0");
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().code, Errc::file);
  EXPECT_NE(bus.error().message.text().find("/nosuchfolder/trace.log"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::can
