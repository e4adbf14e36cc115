#include "can/local.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.hpp"

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Frame frame_of(const char* text) { return parse_frame(text).value(); }
Frame numbered(std::uint32_t id, std::uint32_t number) { return make_frame(id, store_le(number, 4)); }

/// Waits, but not for ever when the code is broken.
std::optional<Frame> next(Bus& bus) { return bus.receive(bus.now() + seconds(20)).value(); }
/// What is there without waiting.
std::optional<Frame> now_at(Bus& bus) { return bus.receive(bus.now()).value(); }

/// Runs a function in a child process; the destructor waits for it.
class Child {
 public:
  template <class Function>
  explicit Child(Function function) : id_(::fork()) {
    if (id_ == 0) ::_exit(function() ? 0 : 1);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { wait(); }

  void kill() { ::kill(id_, SIGKILL); }
  bool wait() {
    int status = 1;
    if (id_ > 0) ::waitpid(std::exchange(id_, -1), &status, 0);
    return status == 0;
  }

 private:
  ::pid_t id_;
};

class LocalBusTest : public testing::Test {
 protected:
  LocalBusTest() {
    std::string name = testing::TempDir() + "servoctl-local-XXXXXX";
    runtime_ = ::mkdtemp(name.data());
    ::setenv("XDG_RUNTIME_DIR", runtime_.c_str(), 1);
  }
  ~LocalBusTest() override {
    ::unsetenv("XDG_RUNTIME_DIR");
    std::filesystem::remove_all(runtime_);
  }

  static std::unique_ptr<Bus> join(const char* name = "demo", Duration send_limit = seconds(20)) {
    auto bus = open_local(name, send_limit);
    EXPECT_TRUE(bus) << bus.error().message;
    return std::move(*bus);
  }

  std::filesystem::path directory() const { return runtime_ / "servoctl" / "bus-demo"; }

  std::size_t member_files() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(directory()))
      count += entry.path().filename().string().starts_with("member-") ? 1U : 0U;
    return count;
  }

  std::filesystem::path runtime_;
};

TEST_F(LocalBusTest, BringsAFrameToAllOthersAndNotBack) {
  const auto a = join();
  const auto b = join();
  const auto c = join();
  ASSERT_TRUE(a->send(frame_of("601#4041600000000000")));
  EXPECT_EQ(now_at(*b), frame_of("601#4041600000000000"));
  EXPECT_EQ(now_at(*c), frame_of("601#4041600000000000"));
  EXPECT_EQ(now_at(*a), std::nullopt);
  EXPECT_EQ(now_at(*b), std::nullopt);
}

TEST_F(LocalBusTest, BringsEveryKindOfFrame) {
  const auto a = join();
  const auto b = join();
  for (const auto* text : {"701#R", "181#R8", "1ABCDEF0#0102030405060708", "00000001#R2",
                           "20000040#0000000000000080", "7FF#", "000#8100"}) {
    ASSERT_TRUE(a->send(frame_of(text)));
    EXPECT_EQ(now_at(*b), frame_of(text)) << text;
  }
}

TEST_F(LocalBusTest, KeepsBusesOfOtherNamesApart) {
  const auto a = join("demo");
  const auto b = join("other");
  ASSERT_TRUE(a->send(frame_of("080#")));
  EXPECT_EQ(now_at(*b), std::nullopt);
}

TEST_F(LocalBusTest, AcceptsFramesWhenNobodyElseIsThere) { EXPECT_TRUE(join()->send(frame_of("080#"))); }

TEST_F(LocalBusTest, ForgetsAMemberThatLeaves) {
  const auto a = join();
  EXPECT_EQ(member_files(), 1U);
  auto b = join();
  EXPECT_EQ(member_files(), 2U);
  b.reset();
  EXPECT_EQ(member_files(), 1U);
  EXPECT_TRUE(a->send(frame_of("080#")));
}

TEST_F(LocalBusTest, RefusesANameThatIsNotPlain) {
  for (const std::string name : {"", "a/b", "..\n", "a b", "ä", "123456789012345678901234567890123"}) {
    const auto bus = open_local(name);
    ASSERT_FALSE(bus) << name;
    EXPECT_EQ(bus.error().code, Errc::usage) << name;
  }
  EXPECT_TRUE(open_local("..A-z_0.9"));
  EXPECT_TRUE(open_local("12345678901234567890123456789012"));
}

TEST_F(LocalBusTest, RefusesADirectoryThatOthersCanEnter) {
  std::filesystem::create_directory(runtime_ / "servoctl");
  ::chmod((runtime_ / "servoctl").c_str(), 0755);
  const auto bus = open_local("demo");
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().code, Errc::bus);
  EXPECT_NE(bus.error().message.find("other users have access"), std::string::npos) << bus.error().message;
}

TEST_F(LocalBusTest, WorksUnderAPathThatIsLongerThanASocketAddress) {
  const auto deep = runtime_ / std::string(120, 'd');
  std::filesystem::create_directory(deep);
  ::setenv("XDG_RUNTIME_DIR", deep.c_str(), 1);
  const auto a = join();
  const auto b = join();
  ASSERT_TRUE(a->send(frame_of("080#")));
  EXPECT_EQ(now_at(*b), frame_of("080#"));
}

TEST_F(LocalBusTest, IgnoresForeignDatagrams) {
  const auto bus = join();
  const Descriptor stranger(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const auto put = [&](const Bytes& datagram) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const auto path = directory().string() + "/member-" + std::to_string(::getpid()) + "-0";
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(::sendto(stranger.get(), datagram.data(), datagram.size(), 0,
                       reinterpret_cast<const sockaddr*>(&address), sizeof address),
              static_cast<ssize_t>(datagram.size()));
  };
  const Bytes good{'S', 'V', 'C', 1, 0, 1, 0, 0, 0x81, 0x05, 0, 0, 0x55, 0, 0, 0, 0, 0, 0, 0};
  auto other_version = good;
  other_version[3] = 2;
  auto too_long = good;
  too_long[5] = 9;
  auto one_more = good;
  one_more.push_back(0);
  for (const auto& datagram : {other_version, too_long, one_more, Bytes(19), Bytes(), good}) put(datagram);
  EXPECT_EQ(now_at(*bus), frame_of("581#55"));
  EXPECT_EQ(now_at(*bus), std::nullopt);
}

TEST_F(LocalBusTest, SaysWhoDoesNotReadAndStillServesTheOthers) {
  const auto sender = join("demo", milliseconds(3));
  const auto reader = join();
  const auto sleeper = join();
  std::uint32_t count = 0;
  auto result = sender->send(numbered(0x181, count));
  for (; result; result = sender->send(numbered(0x181, ++count)))
    ASSERT_EQ(now_at(*reader), numbered(0x181, count));
  EXPECT_EQ(result.error().code, Errc::bus);
  EXPECT_NE(result.error().message.find(std::to_string(::getpid())), std::string::npos);
  EXPECT_EQ(now_at(*reader), numbered(0x181, count));
  for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(now_at(*sleeper), numbered(0x181, i));
  EXPECT_EQ(now_at(*sleeper), std::nullopt);
  EXPECT_TRUE(sender->send(frame_of("080#")));
}

TEST_F(LocalBusTest, SaysThatTheBusIsHeldByAProcessThatHangs) {
  const auto bus = join("demo", milliseconds(3));
  const Descriptor lock(::open((directory() / "lock").c_str(), O_RDWR | O_CLOEXEC));
  ASSERT_EQ(::flock(lock.get(), LOCK_EX), 0);
  const auto sent = bus->send(frame_of("080#"));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, Errc::bus);
  EXPECT_NE(sent.error().hint.find("fuser"), std::string::npos);
  const auto joined = open_local("demo", milliseconds(3));
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().code, Errc::bus);
  EXPECT_EQ(member_files(), 1U);
}

TEST_F(LocalBusTest, TellsAPollLoopWhenAFrameIsThere) {
  const auto a = join();
  const auto b = join();
  EXPECT_EQ(wait_for(b->poll_fd(), POLLIN, TimePoint::min()), Wake::elapsed);
  ASSERT_TRUE(a->send(frame_of("080#")));
  EXPECT_EQ(wait_for(b->poll_fd(), POLLIN, TimePoint::min()), Wake::ready);
}

TEST_F(LocalBusTest, AsksForAttentionWhenFramesCameWhileItSent) {
  const auto a = join("demo", milliseconds(3));
  const auto b = join();
  ASSERT_TRUE(b->send(frame_of("701#05")));
  EXPECT_EQ(a->next_event(), kNever);
  while (a->send(frame_of("080#"))) {
  }
  EXPECT_EQ(a->next_event(), TimePoint::min());
  EXPECT_EQ(now_at(*a), frame_of("701#05"));
  EXPECT_EQ(a->next_event(), kNever);
}

TEST_F(LocalBusTest, JoinsProcessesInOrder) {
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

TEST_F(LocalBusTest, DoesNotBlockTwoMembersThatSendToEachOtherWithoutReading) {
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

TEST_F(LocalBusTest, ShowsAMonitorTheAnswerAfterTheRequest) {
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

TEST_F(LocalBusTest, RemovesTheFileOfAKilledMember) {
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

TEST_F(LocalBusTest, GoesOnWhenAMemberIsKilledWhileItHoldsTheBus) {
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

TEST_F(LocalBusTest, TakesAnotherNameWhenADeadProcessWithItsIdLeftAFile) {
  join().reset();
  ::close(::open((directory() / ("member-" + std::to_string(::getpid()) + "-0")).c_str(), O_CREAT | O_WRONLY,
                 0600));
  const auto a = join();
  const auto b = join();
  ASSERT_TRUE(a->send(frame_of("080#")));
  EXPECT_EQ(now_at(*b), frame_of("080#"));
  EXPECT_EQ(member_files(), 2U);
}

TEST_F(LocalBusTest, LeavesTheMembershipAloneInAForkedChild) {
  auto bus = join();
  Child child([&] {
    bus.reset();
    return true;
  });
  EXPECT_TRUE(child.wait());
  EXPECT_EQ(member_files(), 1U);
}

TEST_F(LocalBusTest, LosesNoMemberWhenManyJoinAtOnce) {
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
