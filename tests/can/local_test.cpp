#include "can/local.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "can/descriptor.hpp"
#include "local_fixture.hpp"

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;

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
  EXPECT_NE(bus.error().message.text().find("other users have access"), std::string::npos)
      << bus.error().message.text();
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
  std::uint32_t count = 0;  // That the sleeper has room for.
  std::vector<Message> told;
  for (; told.empty() && count < 1'000; told = sender->take_notices(), ++count) {
    ASSERT_TRUE(sender->send(numbered(0x181, count)));
    ASSERT_EQ(now_at(*reader), numbered(0x181, count)) << "the others get every frame";
  }
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told.front().text().find(std::to_string(::getpid())), std::string::npos) << told.front().text();
  --count;
  ASSERT_TRUE(sender->send(frame_of("100#")));
  EXPECT_EQ(now_at(*reader), frame_of("100#"));
  EXPECT_TRUE(sender->take_notices().empty()) << "once";
  for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(now_at(*sleeper), numbered(0x181, i));
  EXPECT_EQ(now_at(*sleeper), std::nullopt) << "what came while its queue was full is lost";
  EXPECT_TRUE(sender->send(frame_of("080#")));
  EXPECT_EQ(now_at(*sleeper), frame_of("080#"));
}

TEST_F(LocalBusTest, SaysThatTheBusIsHeldByAProcessThatHangs) {
  const auto bus = join("demo", milliseconds(3));
  const Descriptor lock(::open((directory() / "lock").c_str(), O_RDWR | O_CLOEXEC));
  ASSERT_EQ(::flock(lock.get(), LOCK_EX), 0);
  const auto sent = bus->send(frame_of("080#"));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, Errc::bus);
  EXPECT_NE(sent.error().hint.text().find("fuser"), std::string::npos);
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
  while (a->take_notices().empty()) ASSERT_TRUE(a->send(frame_of("080#")));
  EXPECT_EQ(a->next_event(), TimePoint::min());
  EXPECT_EQ(now_at(*a), frame_of("701#05"));
  EXPECT_EQ(a->next_event(), kNever);
}

}  // namespace
}  // namespace servoctl::can
