#include "can/trace.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/file.hpp"

namespace servoctl::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

Frame parsed(const char* text) { return parse_frame(text).value(); }

/// A bus in virtual time: gives what the test put in, each at its time, and lets time pass while it waits.
class ScriptedBus final : public Bus {
 public:
  explicit ScriptedBus(TimePoint start) : now_(start) {}

  TimePoint now() const override { return now_; }
  Result<void> send(const Frame&) override {
    if (broken) return fail(Errc::bus, "can0 went down");
    return {};
  }
  Result<std::optional<Frame>> receive(TimePoint deadline) override {
    deadlines.push_back(deadline);
    if (broken) return fail(Errc::bus, "can0 went down");
    if (interrupted) return std::optional<Frame>();
    if (!coming.empty() && coming.front().first <= std::max(deadline, now_)) {
      const auto [time, frame] = coming.front();
      coming.pop_front();
      now_ = std::max(now_, time);
      return frame;
    }
    now_ = std::max(now_, deadline);
    return std::optional<Frame>();
  }
  int poll_fd() const override { return 77; }
  TimePoint next_event() const override { return next; }

  std::deque<std::pair<TimePoint, Frame>> coming;
  std::vector<TimePoint> deadlines;  ///< Of every receive().
  TimePoint next = kNever;
  bool broken = false;
  bool interrupted = false;

 private:
  TimePoint now_;
};

class Trace : public testing::Test {
 protected:
  Trace() {
    std::string name = testing::TempDir() + "servoctl-trace-XXXXXX";
    ::close(::mkstemp(name.data()));
    file_ = name;
  }
  ~Trace() override { std::filesystem::remove(file_); }

  std::unique_ptr<Bus> trace(TimePoint start, TraceClock clock = TraceClock::bus) {
    auto inner = std::make_unique<ScriptedBus>(start);
    inner_ = inner.get();
    return trace_to(std::move(inner), file_, "can0", clock).value();
  }
  std::string written() const { return read_file(file_).value(); }

  std::ptrdiff_t lines() const {
    const auto text = written();
    return std::count(text.begin(), text.end(), '\n');
  }

  std::filesystem::path file_;
  ScriptedBus* inner_ = nullptr;
};

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
  bus.reset();
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
  bus.reset();
  EXPECT_EQ(written(), "(0000000000.000000) can0 000#8100\n");
}

TEST_F(Trace, OfARealBusShowsTheTimeOfDay) {
  auto bus = trace(TimePoint{seconds(3)}, TraceClock::wall);
  const auto before = std::chrono::system_clock::now().time_since_epoch();
  ASSERT_TRUE(bus->send(parsed("000#8100")));
  bus.reset();
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
  EXPECT_NE(told.front().message.find("/dev/full"), std::string::npos);
  for (int i = 3; i < 10; ++i) {
    EXPECT_TRUE(bus->send(parsed("080#")));
    EXPECT_TRUE(bus->receive(kStart + i * milliseconds(100)));
  }
  bus.reset();
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
    bus.reset();
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
  EXPECT_NE(bus.error().message.find("nobody reads"), std::string::npos) << bus.error().message;
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
  EXPECT_NE(told.front().find("frames are missing in the trace"), std::string::npos) << told.front();
  EXPECT_TRUE(bus->take_notices().empty());
  const auto missing = std::stoul(told.front());
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
  bus.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, seconds(5));
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told.front().code, Errc::file);
  EXPECT_EQ(std::stoul(told.front().message) + read_lines(), kFrames) << told.front().message;
}

TEST_F(Trace, IsRefusedWhenTheFileCannotBeMade) {
  const auto bus = trace_to(std::make_unique<ScriptedBus>(kStart), "/nosuchfolder/trace.log", "can0");
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().code, Errc::file);
  EXPECT_NE(bus.error().message.find("/nosuchfolder/trace.log"), std::string::npos);
}

TEST(LogLine, IsReadAsCandumpWritesIt) {
  const auto line = parse_log_line("(1736412345.123456) vcan0 601#4041600000000000\r\n");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->time, microseconds(1'736'412'345'123'456));
  EXPECT_EQ(line->interface_name, "vcan0");
  EXPECT_EQ(line->frame, parsed("601#4041600000000000"));
}

TEST(LogLine, IsReadWithDirectionNanosecondsAndMoreSpaces) {
  const auto line = parse_log_line(" (0000000001.500000999)  can0   701#R  T");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->time, microseconds(1'500'000));
  EXPECT_EQ(line->frame, parsed("701#R"));
  EXPECT_TRUE(parse_log_line("(1.5) can0 080# R"));
  EXPECT_EQ(parse_log_line("(1.5) can0 080#")->time, milliseconds(1500));
}

TEST(LogLine, IsRefusedWhenItIsSomethingElse) {
  for (const auto* text :
       {"", "can0 080#", "(1.0) can0", "(1.0) can0 080# X", "(1.0) can0 080# R R", "1.0 can0 080#",
        "(1) can0 080#", "(.5) can0 080#", "(1.) can0 080#", "(1.0000000000) can0 080#", "(-1.0) can0 080#",
        "(1.0) can0 123##10", "(9999999999999.0) can0 080#", "() can0 080#", "( can0 080#", "(1.0)can0 080#",
        "# (1.0) can0 080#"})
    EXPECT_EQ(parse_log_line(text), std::nullopt) << text;
}

RC_GTEST_PROP(LogLine, SurvivesBeingWrittenAndRead, ()) {
  LogFrame line;
  line.time = microseconds(*rc::gen::inRange<std::int64_t>(0, 4'000'000'000'000'000));
  line.interface_name = "can1";
  line.frame = make_frame(*rc::gen::inRange<std::uint32_t>(0, 0x800),
                          *rc::gen::arbitrary<std::vector<std::uint8_t>>());
  RC_ASSERT(parse_log_line(to_string(line)) == line);
}

RC_GTEST_PROP(LogLine, NeverMakesTheReaderFail, ()) {
  parse_log_line(*rc::gen::container<std::string>(rc::gen::elementOf(std::string("(1.) can#R\n\xff"))));
}

}  // namespace
}  // namespace servoctl::can
