#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "can/descriptor.hpp"
#include "local_fixture.hpp"

namespace servoctl::can {
namespace {

/// Runs a function in a child process, which is killed at the latest by the destructor. wait() is true when
/// the function was.
class Child {
 public:
  template <class Function>
  explicit Child(Function function) : id_(::fork()) {
    if (id_ == 0) ::_exit(function() ? 0 : 1);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    kill();
    wait();
  }

  void kill() const {
    if (id_ > 0) ::kill(id_, SIGKILL);
  }
  bool wait() {
    int status = 1;
    if (id_ > 0) ::waitpid(std::exchange(id_, -1), &status, 0);
    return status == 0;
  }

 private:
  ::pid_t id_;
};

using LocalBusProcesses = LocalBusTest;

TEST_F(LocalBusProcesses, JoinsProcessesInOrder) {
  constexpr std::uint32_t kCount = 2000;
  const auto bus = join();
  Child child([] {
    const auto own = join();
    for (std::uint32_t i = 0; i < kCount; ++i)
      if (!own->send(numbered(0x181, i))) return false;
    return true;
  });
  for (std::uint32_t i = 0; i < kCount; ++i) ASSERT_EQ(next(*bus), numbered(0x181, i));
  EXPECT_TRUE(child.wait());
  EXPECT_EQ(member_files(), 1U);
}

TEST_F(LocalBusProcesses, DoesNotBlockTwoMembersThatSendToEachOtherWithoutReading) {
  constexpr std::uint32_t kCount = 2000;
  const auto talk = [](Bus& bus, std::uint32_t own_id, std::uint32_t other_id) {
    for (std::uint32_t i = 0; i < kCount; ++i)
      if (!bus.send(numbered(own_id, i))) return false;
    for (std::uint32_t i = 0; i < kCount; ++i)
      if (next(bus) != numbered(other_id, i)) return false;
    return true;
  };
  const auto bus = join();
  Child child([&] {
    const auto own = join();
    return own->send(frame_of("701#00")) && next(*own) == frame_of("080#") && talk(*own, 0x182, 0x181);
  });
  ASSERT_EQ(next(*bus), frame_of("701#00"));
  ASSERT_TRUE(bus->send(frame_of("080#")));
  EXPECT_TRUE(talk(*bus, 0x181, 0x182));
  EXPECT_TRUE(child.wait());
}

TEST_F(LocalBusProcesses, ShowsAMonitorTheAnswerAfterTheRequest) {
  constexpr std::uint32_t kCount = 2000;
  const auto client = join();
  Child drive([] {
    const auto own = join();
    if (!own->send(frame_of("701#00"))) return false;
    for (std::uint32_t i = 0; i < kCount; ++i)
      if (next(*own) != numbered(0x601, i) || !own->send(numbered(0x581, i))) return false;
    return true;
  });
  ASSERT_EQ(next(*client), frame_of("701#00"));
  const auto monitor = join();
  for (std::uint32_t i = 0; i < kCount; ++i) {
    ASSERT_TRUE(client->send(numbered(0x601, i)));
    ASSERT_EQ(next(*monitor), numbered(0x601, i));
    ASSERT_EQ(next(*monitor), numbered(0x581, i));
    ASSERT_EQ(next(*client), numbered(0x581, i));
  }
  EXPECT_TRUE(drive.wait());
}

TEST_F(LocalBusProcesses, RemovesTheFileOfAKilledMember) {
  const auto bus = join();
  Child victim([] {
    const auto own = join();
    return own->send(frame_of("701#00")) && ::pause() != 0;
  });
  ASSERT_EQ(next(*bus), frame_of("701#00"));
  victim.kill();
  victim.wait();
  EXPECT_EQ(member_files(), 2U);
  ASSERT_TRUE(bus->send(frame_of("080#")));
  EXPECT_EQ(member_files(), 1U);
}

TEST_F(LocalBusProcesses, GoesOnWhenAMemberIsKilledWhileItHoldsTheBus) {
  const auto bus = join();
  Child victim([this] {
    const Descriptor lock(::open((directory() / "lock").c_str(), O_RDWR | O_CLOEXEC));
    const auto own = join();
    return own->send(frame_of("701#00")) && ::flock(lock.get(), LOCK_EX) == 0 && ::pause() != 0;
  });
  ASSERT_EQ(next(*bus), frame_of("701#00"));
  const Descriptor lock(::open((directory() / "lock").c_str(), O_RDWR | O_CLOEXEC));
  while (::flock(lock.get(), LOCK_EX | LOCK_NB) == 0) ::flock(lock.get(), LOCK_UN);
  victim.kill();
  EXPECT_TRUE(bus->send(frame_of("080#")));
}

TEST_F(LocalBusProcesses, TakesAnotherNameWhenADeadProcessWithItsIdLeftAFile) {
  join().reset();
  ::close(::open((directory() / ("member-" + std::to_string(::getpid()) + "-0")).c_str(), O_CREAT | O_WRONLY,
                 0600));
  const auto a = join();
  const auto b = join();
  ASSERT_TRUE(a->send(frame_of("080#")));
  EXPECT_EQ(now_at(*b), frame_of("080#"));
  EXPECT_EQ(member_files(), 2U);
}

TEST_F(LocalBusProcesses, LeavesTheMembershipAloneInAForkedChild) {
  auto bus = join();
  Child child([&] {
    bus.reset();
    return true;
  });
  EXPECT_TRUE(child.wait());
  EXPECT_EQ(member_files(), 1U);
}

TEST_F(LocalBusProcesses, LosesNoMemberWhenManyJoinAtOnce) {
  constexpr int kChildren = 12;
  const auto bus = join();
  std::vector<std::unique_ptr<Child>> children;
  for (int i = 0; i < kChildren; ++i)
    children.push_back(std::make_unique<Child>([] {
      const auto own = join();
      if (!own->send(frame_of("701#00"))) return false;
      for (auto frame = next(*own); frame; frame = next(*own))
        if (frame == frame_of("000#0200")) return true;
      return false;
    }));
  for (int i = 0; i < kChildren; ++i) ASSERT_EQ(next(*bus), frame_of("701#00"));
  ASSERT_TRUE(bus->send(frame_of("000#0200")));
  for (const auto& child : children) EXPECT_TRUE(child->wait());
}

}  // namespace
}  // namespace servoctl::can
