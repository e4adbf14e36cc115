#include "can/socketcan.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/signal_wait.hpp"

namespace servoctl::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// The 16 bytes of struct can_frame: identifier with flags in the order of the machine, length, 3 unused,
/// data.
using Raw = std::array<std::uint8_t, 16>;

Raw raw_frame(std::uint32_t id, std::uint8_t size, const std::vector<std::uint8_t>& data) {
  Raw raw{};
  std::memcpy(raw.data(), &id, sizeof id);
  raw[4] = size;
  std::copy(data.begin(), data.end(), raw.begin() + 8);
  return raw;
}

Frame frame_of(const char* text) { return parse_frame(text).value(); }

/// A SocketCanBus on one end of a socketpair; the test is the kernel at the other end.
class SocketCan : public testing::Test {
 protected:
  SocketCan() { connect(SOCK_DGRAM); }

  void connect(int type, const std::string& name = "can0") {
    int ends[2];
    ASSERT_EQ(::socketpair(AF_UNIX, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    kernel_ = Descriptor(ends[1]);
    bus_ = std::make_unique<SocketCanBus>(Descriptor(ends[0]), name, milliseconds(3));
  }

  void put(const Raw& raw) const {
    ASSERT_EQ(::send(kernel_.get(), raw.data(), raw.size(), 0), static_cast<ssize_t>(raw.size()));
  }

  std::optional<Raw> sent() const {
    Raw raw{};
    const auto size = ::recv(kernel_.get(), raw.data(), raw.size(), 0);
    return size == static_cast<ssize_t>(raw.size()) ? std::optional(raw) : std::nullopt;
  }

  /// What is there without waiting.
  std::optional<Frame> received() const { return bus_->receive(bus_->now()).value(); }

  Descriptor kernel_;
  std::unique_ptr<SocketCanBus> bus_;
};

TEST_F(SocketCan, SendsADataFrame) {
  ASSERT_TRUE(bus_->send(frame_of("601#4041600000000000")));
  EXPECT_EQ(sent(), raw_frame(0x601, 8, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0}));
}

TEST_F(SocketCan, SendsARemoteFrameWithItsFlagAndLength) {
  ASSERT_TRUE(bus_->send(frame_of("701#R1")));
  EXPECT_EQ(sent(), raw_frame(0x4000'0701, 1, {}));
}

TEST_F(SocketCan, SendsA29BitIdentifierWithItsFlag) {
  ASSERT_TRUE(bus_->send(frame_of("1ABCDEF0#01")));
  EXPECT_EQ(sent(), raw_frame(0x9ABC'DEF0, 1, {0x01}));
}

TEST_F(SocketCan, SendsNothingThatADriverWouldTurnIntoAnotherFrame) {
  auto too_long = frame_of("601#");
  too_long.size = 9;
  auto too_high = frame_of("601#");
  too_high.id = 0x800;
  for (const auto& frame : {frame_of("20000004#0001000000000000"), too_long, too_high}) {
    const auto result = bus_->send(frame);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::bug);
  }
  EXPECT_EQ(sent(), std::nullopt);
}

TEST_F(SocketCan, ReceivesADataFrame) {
  put(raw_frame(0x581, 4, {0x60, 0x40, 0x60, 0x00}));
  EXPECT_EQ(received(), frame_of("581#60406000"));
}

TEST_F(SocketCan, ReceivesRemoteAnd29BitFrames) {
  put(raw_frame(0x4000'0701, 1, {}));
  put(raw_frame(0x8000'0123, 1, {0x55}));
  EXPECT_EQ(received(), frame_of("701#R1"));
  EXPECT_EQ(received(), frame_of("00000123#55"));
}

/// 72 bytes: struct canfd_frame. It has no place in a frame of CANopen, and must not look like silence.
TEST_F(SocketCan, CountsCanFdFramesAndGivesTheOthers) {
  std::array<std::uint8_t, 72> fd{};
  fd[0] = 0x81;
  fd[1] = 0x05;
  fd[4] = 64;
  ASSERT_EQ(::send(kernel_.get(), fd.data(), fd.size(), 0), 72);
  put(raw_frame(0x581, 1, {0x60}));
  ASSERT_EQ(::send(kernel_.get(), fd.data(), fd.size(), 0), 72);
  EXPECT_EQ(received(), frame_of("581#60"));
  EXPECT_EQ(received(), std::nullopt);
  EXPECT_EQ(bus_->take_notices(),
            std::vector<Message>{"can0: 2 CAN FD frames came; servoctl reads frames of classical CAN only"});
  EXPECT_TRUE(bus_->take_notices().empty());
  EXPECT_EQ(bus_->fd_frames(), 2U) << "since it was opened";
}

TEST_F(SocketCan, ReceivesReportsOfTheControllerAsErrors) {
  put(raw_frame(0x2000'0040, 8, {0, 0, 0, 0, 0, 0, 0x80, 0x90}));
  const auto bus_off = received();
  ASSERT_TRUE(bus_off);
  EXPECT_TRUE(bus_off->error);
  EXPECT_FALSE(bus_off->extended);
  EXPECT_EQ(bus_off->id, 0x40U);
  EXPECT_EQ(bus_off->data[7], 0x90);
}

TEST_F(SocketCan, SendsNothingWhileTheControllerIsBusOff) {
  put(raw_frame(0x2000'0040, 8, {}));
  put(raw_frame(0x2000'0004, 8, {0, 0x04}));
  EXPECT_TRUE(received() && received());
  const auto result = bus_->send(frame_of("000#8100"));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::bus);
  EXPECT_NE(result.error().message.text().find("bus-off"), std::string::npos);
  EXPECT_EQ(sent(), std::nullopt);
}

TEST_F(SocketCan, SendsAgainWhenTheControllerWasRestarted) {
  put(raw_frame(0x2000'0040, 8, {}));
  put(raw_frame(0x2000'0100, 8, {}));
  EXPECT_TRUE(received() && received());
  EXPECT_TRUE(bus_->send(frame_of("000#8100")));
}

/// An answer that was on its way when the controller left: taken for a bus that works, the way down of a
/// motor would go on without a bus.
TEST_F(SocketCan, SendsNothingBecauseAFrameCameBehindTheReport) {
  put(raw_frame(0x2000'0040, 8, {}));
  put(raw_frame(0x581, 8, {0x4B, 0x41, 0x60}));
  EXPECT_TRUE(received() && received());
  const auto result = bus_->send(frame_of("000#8100"));
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.text().find("bus-off"), std::string::npos);
}

TEST_F(SocketCan, SendsAgainWhenAFrameComesOverAnInterfaceWithACarrier) {
  if (socketcan_carrier("lo") != true) GTEST_SKIP() << "there is no interface with a carrier";
  connect(SOCK_DGRAM, "lo");
  put(raw_frame(0x2000'0040, 8, {}));
  put(raw_frame(0x701, 1, {0}));
  EXPECT_TRUE(received() && received());
  EXPECT_TRUE(bus_->send(frame_of("000#8100")));
}

TEST_F(SocketCan, IgnoresWhatLiesBehindTheLengthOfAFrame) {
  put(raw_frame(0x581, 2, {1, 2, 3, 4}));
  put(raw_frame(0x4000'0701, 1, {9}));
  put(raw_frame(0x582, 15, {1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(received(), frame_of("581#0102"));
  EXPECT_EQ(received(), frame_of("701#R1"));
  EXPECT_EQ(received(), frame_of("582#0102030405060708"));
}

TEST_F(SocketCan, IgnoresADatagramOfAnotherSize) {
  ASSERT_EQ(::send(kernel_.get(), "short", 5, 0), 5);
  put(raw_frame(0x581, 0, {}));
  EXPECT_EQ(received(), frame_of("581#"));
}

TEST_F(SocketCan, KeepsTheOrderOfFrames) {
  for (std::uint8_t i = 0; i < 8; ++i) put(raw_frame(0x181, 1, {i}));
  for (std::uint8_t i = 0; i < 8; ++i) EXPECT_EQ(received(), make_frame(0x181, std::array{i}));
  EXPECT_EQ(received(), std::nullopt);
}

TEST_F(SocketCan, EmptiesTheKernelsQueueBeforeItGivesOutManyFrames) {
  connect(SOCK_SEQPACKET);
  constexpr std::uint8_t kFrames = 200;
  for (std::uint8_t i = 0; i < kFrames; ++i) put(raw_frame(0x181, 1, {i}));
  for (std::uint8_t i = 0; i < kFrames; ++i) {
    const auto frame = bus_->receive(bus_->now());
    ASSERT_TRUE(frame && *frame);
    EXPECT_EQ((*frame)->data[0], i);
    pollfd waiting{bus_->poll_fd(), POLLIN, 0};
    if (i == 20) {
      EXPECT_EQ(::poll(&waiting, 1, 0), 0) << "frames wait where the kernel may drop them";
    }
  }
  EXPECT_FALSE(*bus_->receive(bus_->now()));
}

TEST_F(SocketCan, AsksOnceWhenTheDeadlineHasPassed) {
  EXPECT_EQ(bus_->receive(TimePoint::min()).value(), std::nullopt);
  put(raw_frame(0x581, 0, {}));
  EXPECT_EQ(bus_->receive(TimePoint::min()).value(), frame_of("581#"));
}

TEST_F(SocketCan, WaitsUntilTheDeadlineAndNotMuchLonger) {
  auto shortest = Duration::max();
  for (int i = 0; i < 50; ++i) {
    const auto start = bus_->now();
    ASSERT_EQ(bus_->receive(start + microseconds(300)).value(), std::nullopt);
    ASSERT_GE(bus_->now() - start, microseconds(300));
    shortest = std::min(shortest, bus_->now() - start);
  }
  EXPECT_LT(shortest, milliseconds(1));
}

TEST_F(SocketCan, ReturnsEarlyWithNothingWhenASignalArrives) {
  struct sigaction handler {};
  handler.sa_handler = [](int) { note_signal(); };
  struct sigaction before {};
  ASSERT_EQ(::sigaction(SIGALRM, &handler, &before), 0);
  const itimerval every_millisecond{{0, 1000}, {0, 1000}};
  ASSERT_EQ(::setitimer(ITIMER_REAL, &every_millisecond, nullptr), 0);
  const auto deadline = bus_->now() + seconds(20);
  const auto result = bus_->receive(deadline);
  const itimerval off{};
  ::setitimer(ITIMER_REAL, &off, nullptr);
  ::sigaction(SIGALRM, &before, nullptr);
  ASSERT_TRUE(result);
  EXPECT_EQ(*result, std::nullopt);
  EXPECT_LT(bus_->now(), deadline);
}

TEST_F(SocketCan, DoesNotWaitAfterASignalThatCameBefore) {
  note_signal();
  const auto start = bus_->now();
  EXPECT_EQ(bus_->receive(start + seconds(5)).value(), std::nullopt);
  EXPECT_LT(bus_->now() - start, seconds(1));
}

TEST_F(SocketCan, WaitsInSlicesUntilTheDeadlineAndTakesWhatComesInBetween) {
  auto start = bus_->now();
  EXPECT_EQ(bus_->receive(start + milliseconds(65)).value(), std::nullopt);
  EXPECT_GE(bus_->now() - start, milliseconds(65));
  std::thread kernel([this] {
    std::this_thread::sleep_for(milliseconds(30));
    for (std::uint8_t i = 1; i <= 3; ++i) put(raw_frame(0x581, 1, {i}));
  });
  start = bus_->now();
  for (std::uint8_t i = 1; i <= 3; ++i)
    EXPECT_EQ(bus_->receive(start + seconds(5)).value(), make_frame(0x581, std::array{i}));
  EXPECT_LT(bus_->now() - start, seconds(1));
  kernel.join();
}

TEST_F(SocketCan, TellsAPollLoopWhenAFrameIsThere) {
  EXPECT_EQ(wait_for(bus_->poll_fd(), POLLIN, TimePoint::min()), Wake::elapsed);
  put(raw_frame(0x581, 0, {}));
  EXPECT_EQ(wait_for(bus_->poll_fd(), POLLIN, TimePoint::min()), Wake::ready);
  EXPECT_EQ(bus_->next_event(), kNever);
}

TEST_F(SocketCan, SaysWhatToDoWhenTheTransmitQueueStaysFull) {
  auto result = bus_->send(frame_of("080#"));
  while (result) result = bus_->send(frame_of("080#"));
  EXPECT_EQ(result.error().code, Errc::bus);
  EXPECT_EQ(result.error().message.text(), "the transmit queue of can0 remains full");
  EXPECT_NE(result.error().hint.text().find("txqueuelen 1000"), std::string::npos);
  while (sent()) {
  }
  EXPECT_TRUE(bus_->send(frame_of("080#")));
}

TEST_F(SocketCan, FailsWhenTheOtherEndIsGone) {
  kernel_ = Descriptor();
  const auto result = bus_->send(frame_of("080#"));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::bus);
  EXPECT_NE(result.error().message.text().find("can0 failed"), std::string::npos);
}

TEST_F(SocketCan, FailsInsteadOfWaitingOnAClosedConnection) {
  connect(SOCK_SEQPACKET);
  kernel_ = Descriptor();
  const auto result = bus_->receive(kNever);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::bus);
}

TEST(WaitFor, SleepsUntilTheDeadline) {
  const auto deadline = steady_now() + microseconds(300);
  EXPECT_EQ(wait_for(-1, POLLIN, deadline), Wake::elapsed);
  EXPECT_GE(steady_now(), deadline);
}

}  // namespace
}  // namespace servoctl::can
