#include "can/descriptor.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <thread>

namespace servoctl::can {
namespace {

TEST(Descriptor, APeerThatNeverStopsSendingIsTakenInByParts) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
  const Descriptor out(ends[0]);
  Descriptor in(ends[1]);
  std::atomic<bool> over{false};
  std::thread peer([&] {
    const std::string much(1U << 16U, 'x');
    while (!over) (void)!::write(in.get(), much.data(), much.size());
  });
  for (int part = 0; part < 100; ++part) {
    std::string bytes;
    EXPECT_TRUE(take_in(out.get(), bytes).there);
    EXPECT_LE(bytes.size(), (std::size_t{1} << 16U) + 8192);
  }
  over = true;
  peer.join();
  in = Descriptor();
}

TEST(Descriptor, TheEndOfAPeerIsTold) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
  const Descriptor out(ends[0]);
  ASSERT_EQ(::write(ends[1], "abc", 3), 3);
  std::string bytes;
  EXPECT_TRUE(take_in(out.get(), bytes).there);
  EXPECT_EQ(bytes, "abc");
  ::close(ends[1]);
  EXPECT_FALSE(take_in(out.get(), bytes).there);
}

}  // namespace
}  // namespace servoctl::can
