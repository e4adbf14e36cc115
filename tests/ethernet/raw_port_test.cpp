// Ethernet interfaces of the kernel: what can be known without one, and a port on one end of a socketpair.
// Real interfaces are in tests/real.
#include "ethernet/raw_port.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>

#include "base/signal_wait.hpp"
#include "child.hpp"
#include "ethernet/interface.hpp"
#include "frames.hpp"

namespace servoctl::ethernet {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class RawPortTest : public testing::Test {
 protected:
  RawPortTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    wire_ = can::Descriptor(ends[1]);
    port_ = std::make_unique<RawPort>(can::Descriptor(ends[0]), std::nullopt, "nosuch7", End::master);
  }
  void arrive(const Bytes& frame) const {
    EXPECT_EQ(::send(wire_.get(), frame.data(), frame.size(), 0), static_cast<ssize_t>(frame.size()));
  }
  can::Descriptor wire_;
  std::unique_ptr<RawPort> port_;
};

TEST_F(RawPortTest, AFrameGoesOutAsItIs) {
  const auto frame = frame_of(3, 1514);
  ASSERT_TRUE(port_->send(frame));
  Bytes out(2000);
  const auto size = ::recv(wire_.get(), out.data(), out.size(), 0);
  ASSERT_EQ(size, 1514);
  out.resize(1514);
  EXPECT_EQ(out, frame);
}

TEST_F(RawPortTest, FramesComeInTheirOrderAndOneThatIsTooLongDoesNot) {
  arrive(frame_of(1));
  arrive(frame_of(2, 1515));
  arrive(frame_of(3, 1514));
  EXPECT_EQ(copy(**port_->receive(port_->now())), frame_of(1));
  const auto second = port_->receive(port_->now() + seconds(20));
  EXPECT_EQ(copy(**second), frame_of(3, 1514));
  EXPECT_LE(port_->arrived(), port_->now());
  EXPECT_GT(port_->arrived(), port_->now() - seconds(20));
  EXPECT_FALSE(*port_->receive(port_->now()));
}

TEST_F(RawPortTest, WaitsInSlicesUntilTheDeadlineAndASignalEndsIt) {
  const auto deadline = port_->now() + milliseconds(30);
  EXPECT_FALSE(*port_->receive(deadline));
  EXPECT_GE(port_->now(), deadline);
  note_signal();
  EXPECT_FALSE(*port_->receive(port_->now() + std::chrono::hours(1)));
  arrive(frame_of(1));
  EXPECT_EQ(copy(**port_->receive(port_->now() + std::chrono::hours(1))), frame_of(1));
}

TEST_F(RawPortTest, ItsDescriptorTellsWhenAFrameIsThere) {
  pollfd entry{port_->poll_fd(), POLLIN, 0};
  EXPECT_EQ(::poll(&entry, 1, 0), 0);
  arrive(frame_of(1));
  EXPECT_EQ(::poll(&entry, 1, 0), 1);
}

TEST_F(RawPortTest, AnInterfaceThatIsGoneIsTold) {
  wire_ = can::Descriptor();
  const auto sent = port_->send(frame_of(1));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, Errc::bus);
  EXPECT_EQ(sent.error().message.text(), "nosuch7 went down: the interface is gone");
  EXPECT_FALSE(port_->has_link());
  const auto back = port_->recover(port_->now() + milliseconds(12));
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().message.text(), "there is no interface nosuch7");
}

TEST(OpenRawPort, ANameThatNoInterfaceCanHaveIsRefused) {
  for (const auto* name : {"", "sixteencharsname", "../eth0"}) {
    const auto port = open_raw_port(name);
    ASSERT_FALSE(port) << name;
    EXPECT_EQ(port.error().code, Errc::usage) << name;
  }
}

TEST(OpenRawPort, AMissingInterfaceIsToldWithThoseThereAre) {
  const auto port = open_raw_port("nosucheth7");
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, Errc::bus);
  EXPECT_EQ(port.error().message.text(), "there is no interface nosucheth7");
  EXPECT_NE(port.error().hint.text().find("`ip link` lists all interfaces"), std::string::npos)
      << port.error().hint.text();
  for (const auto& name : ethernet_interfaces())
    EXPECT_NE(port.error().hint.text().find(name), std::string::npos) << port.error().hint.text();
}

TEST(OpenRawPort, LoopbackIsNoWire) {
  const auto port = open_raw_port("lo");
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, Errc::bus);
  EXPECT_EQ(port.error().message.text(), "lo leads back to this machine: no drive can be on it");
}

TEST(EthernetInterfaces, LeaveOutOtherNetworks) {
  const auto names = ethernet_interfaces();
  EXPECT_EQ(std::count(names.begin(), names.end(), "lo"), 0);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
}

TEST(EthernetInterfaces, WhoMayNotSendIsGivenTheCommandForThisVeryProgram) {
  const auto error = no_right("eth0").value();
  EXPECT_EQ(error.message.text(), "no right to send Ethernet frames on eth0");
  EXPECT_NE(error.hint.text().find("`sudo setcap cap_net_raw+ep /"), std::string::npos) << error.hint.text();
  EXPECT_NE(error.hint.text().find("ethernet_tests`"), std::string::npos) << error.hint.text();
}

TEST(WireLock, OnlyOneProcessHoldsAWireAndItIsNamed) {
  const auto key = "test-" + std::to_string(::getpid());
  Child other([&](const auto& ready) {
    const auto lock = WireLock::take(key, "eth0");
    if (lock) ready();
    for (;;) ::pause();
  });
  ASSERT_TRUE(other.is_ready());
  for (int i = 0; i < 3; ++i) {
    const auto lock = WireLock::take(key, "eth0");
    ASSERT_FALSE(lock);
    EXPECT_EQ(lock.error().code, Errc::bus);
    EXPECT_EQ(lock.error().message.text().find("eth0 is in use by process " + std::to_string(other.id()) +
                                               " (ethernet_tests"),
              0U)
        << lock.error().message.text();
    EXPECT_NE(lock.error().hint.text().find("`ps -fp " + std::to_string(other.id()) + "` shows it"),
              std::string::npos);
  }
  EXPECT_TRUE(WireLock::take(key + "b", "eth1"));
  other.kill();
  EXPECT_TRUE(WireLock::take(key, "eth0"));
}

}  // namespace
}  // namespace servoctl::ethernet
