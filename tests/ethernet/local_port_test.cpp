// The virtual cable between two processes of one machine.
#include "ethernet/local_port.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "child.hpp"
#include "frames.hpp"

namespace servoctl::ethernet {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Sends back what comes, with another first byte, until it is killed.
void echo(Port& ring) {
  for (;;) {
    const auto frame = ring.receive(ring.now() + seconds(60));
    if (!frame || !*frame) continue;
    auto back = copy(**frame);
    back[0] ^= 0xFF;
    if (!ring.send(back)) return;
  }
}

/// A runtime directory of its own for each test.
class LocalPortTest : public testing::Test {
 protected:
  LocalPortTest() {
    std::string name = testing::TempDir() + "servoctl-cable-XXXXXX";
    runtime_ = ::mkdtemp(name.data());
    ::setenv("XDG_RUNTIME_DIR", runtime_.c_str(), 1);
  }
  ~LocalPortTest() override {
    ::unsetenv("XDG_RUNTIME_DIR");
    std::filesystem::remove_all(runtime_);
  }

  static auto serving() {
    return [](const auto& ready) {
      const auto ring = open_local_port("demo", End::ring);
      if (!ring) return;
      ready();
      echo(**ring);
    };
  }
  static std::unique_ptr<Port> join() {
    auto port = open_local_port("demo", End::master, seconds(20));
    EXPECT_TRUE(port) << port.error().message.text();
    return port ? std::move(*port) : nullptr;
  }
  static Error refused(End end = End::master, Duration patience = seconds(20)) {
    const auto port = open_local_port("demo", end, patience);
    EXPECT_FALSE(port);
    return port ? Error{} : port.error();
  }
  /// Waits, but not for ever when the code is broken.
  static Bytes next(Port& port) {
    const auto frame = port.receive(port.now() + seconds(20));
    return frame && *frame ? copy(**frame) : Bytes();
  }

  std::filesystem::path runtime_;
};

TEST_F(LocalPortTest, FramesOfEveryLengthComeBackFromTheRing) {
  const Child ring(serving());
  ASSERT_TRUE(ring.is_ready());
  const auto master = join();
  ASSERT_TRUE(master);
  EXPECT_TRUE(master->has_link());
  for (const std::size_t size : {60U, 61U, 1000U, 1514U}) {
    auto frame = frame_of(1, size);
    ASSERT_TRUE(master->send(frame));
    frame[0] ^= 0xFF;
    EXPECT_EQ(next(*master), frame);
  }
  EXPECT_FALSE(*master->receive(master->now()));
}

TEST_F(LocalPortTest, AFrameThatIsTooLongIsABug) {
  const Child ring(serving());
  const auto master = join();
  ASSERT_TRUE(master);
  EXPECT_EQ(master->send(Bytes(1515)).error().code, Errc::bug);
}

TEST_F(LocalPortTest, ARingThatNobodyServesIsToldWithWhatServesIt) {
  const auto error = refused();
  EXPECT_EQ(error.code, Errc::bus);
  EXPECT_EQ(error.message.text(), "nobody serves coe:local:demo");
  EXPECT_EQ(error.hint.text(), "start `servoctl sim sv2@1 --bus coe:local:demo`");
}

TEST_F(LocalPortTest, ASecondMasterIsRefusedAndTheFirstIsNamed) {
  const Child ring(serving());
  const Child first([](const auto& ready) {
    const auto master = join();
    ready();
    (void)master->receive(master->now() + seconds(60));
  });
  ASSERT_TRUE(first.is_ready());
  const auto error = refused();
  EXPECT_EQ(error.code, Errc::bus);
  EXPECT_NE(
      error.message.text().find("coe:local:demo is in use by process " + std::to_string(first.id()) + " ("),
      std::string::npos)
      << error.message.text();
}

TEST_F(LocalPortTest, ASecondRingIsRefusedAndTheFirstIsNamed) {
  const Child ring(serving());
  const auto error = refused(End::ring);
  EXPECT_EQ(error.code, Errc::bus);
  EXPECT_NE(error.message.text().find("coe:local:demo is served already, by process " +
                                      std::to_string(ring.id()) + " ("),
            std::string::npos)
      << error.message.text();
}

TEST_F(LocalPortTest, AMasterThatWasKilledHindersNobody) {
  const Child ring(serving());
  for (int i = 0; i < 50; ++i) {
    Child first([](const auto& ready) {
      const auto master = join();
      for (int k = 0; k < 10; ++k) (void)master->send(frame_of(9));
      ready();
      for (;;) (void)master->send(frame_of(9));
    });
    ASSERT_TRUE(first.is_ready());
    first.kill();
    const auto master = join();
    ASSERT_TRUE(master);
    ASSERT_TRUE(master->send(frame_of(1)));
    auto back = frame_of(1);
    back[0] ^= 0xFF;
    EXPECT_EQ(next(*master), back);
  }
}

TEST_F(LocalPortTest, ARingThatWasKilledIsToldAndItsSuccessorTakenUp) {
  auto ring = std::make_unique<Child>(serving());
  const auto master = join();
  ASSERT_TRUE(master);
  const int descriptor = master->poll_fd();
  const auto id = std::to_string(ring->id());
  ring->kill();
  const auto lost = master->receive(master->now() + seconds(20));
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, Errc::bus);
  EXPECT_EQ(lost.error().message.text(), "coe:local:demo is gone: process " + id + " served it");
  EXPECT_EQ(master->recover(master->now()).error().message.text(), "nobody serves coe:local:demo");
  ring = std::make_unique<Child>(serving());
  ASSERT_TRUE(ring->is_ready());
  ASSERT_TRUE(master->recover(master->now() + seconds(20)));
  EXPECT_EQ(master->poll_fd(), descriptor);
  ASSERT_TRUE(master->send(frame_of(1)));
  EXPECT_FALSE(next(*master).empty());
}

TEST_F(LocalPortTest, ARingThatHangsIsToldAndNotWaitedForWithoutEnd) {
  const Child ring(serving());
  ring.stop();
  const auto error = refused(End::master, milliseconds(10));
  EXPECT_EQ(error.code, Errc::bus);
  const auto begin = "coe:local:demo does not answer: process " + std::to_string(ring.id()) + " ";
  EXPECT_EQ(error.message.text().substr(0, begin.size()), begin);
  EXPECT_NE(error.hint.text().find("kill -CONT " + std::to_string(ring.id())), std::string::npos)
      << error.hint.text();
}

TEST_F(LocalPortTest, ACableThatIsStillThereIsNotOpenedAnew) {
  const Child ring(serving());
  const auto master = join();
  const auto began = steady_now();
  const auto back = master->recover(began + seconds(20));
  ASSERT_TRUE(back) << back.error().message.text();
  EXPECT_LT(steady_now() - began, seconds(1));
  ASSERT_TRUE(master->send(frame_of(1, 60)));
  EXPECT_EQ(next(*master).size(), 60U);
}

TEST_F(LocalPortTest, FramesForAProcessThatDoesNotReadAreLost) {
  const Child ring(serving());
  const auto master = join();
  ring.stop();
  for (int i = 0; i < 5000; ++i) ASSERT_TRUE(master->send(frame_of(1, 1514)));
}

TEST_F(LocalPortTest, ARingWithoutAMasterSendsToNobody) {
  const auto ring = open_local_port("demo", End::ring);
  ASSERT_TRUE(ring);
  EXPECT_FALSE((*ring)->has_link());
  EXPECT_TRUE((*ring)->send(frame_of(1)));
  EXPECT_FALSE(*(*ring)->receive((*ring)->now()));
}

TEST_F(LocalPortTest, NamesAreThoseOfALocalBusAndNoneOfThem) {
  EXPECT_EQ(open_local_port("a/b").error().code, Errc::usage);
  EXPECT_EQ(open_local_port("a/b", End::ring).error().code, Errc::usage);
  const auto ring = open_local_port("demo", End::ring);
  ASSERT_TRUE(ring);
  EXPECT_TRUE(std::filesystem::exists(runtime_ / "servoctl" / "bus-coe:demo" / "ring"));
}

}  // namespace
}  // namespace servoctl::ethernet
