#include "can/byte_window.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>

#include "can/recording.hpp"

namespace servoctl::can {
namespace {

/// The end of a pipe from which `content` can be read; it fits into the pipe.
Descriptor pipe_with(std::string_view content) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  EXPECT_EQ(::write(ends[1], content.data(), content.size()), static_cast<ssize_t>(content.size()));
  ::close(ends[1]);
  return Descriptor(ends[0]);
}

TEST(ByteWindow, ReadsAPipeToItsEnd) {
  ByteWindow bytes(pipe_with("abcdef"));
  EXPECT_EQ(bytes.ahead(2).substr(0, 2), "ab");
  bytes.drop(4);
  EXPECT_EQ(bytes.offset(), 4U);
  EXPECT_EQ(bytes.ahead(100), "ef");
  bytes.drop(100);
  EXPECT_TRUE(bytes.at_end());
  EXPECT_EQ(bytes.offset(), 6U);
}

TEST(ByteWindow, TellsBeforeItWaits) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  std::size_t idle = 0;
  ByteWindow bytes{Descriptor(ends[0]), [&] {
                     // Whoever waits for more gets it, and then the end.
                     if (idle++ == 0)
                       EXPECT_EQ(::write(ends[1], "(1.0) can0 701#85000000000000FF\n", 32), 32);
                     else
                       ::close(ends[1]);
                   }};
  std::size_t frames = 0;
  (void)for_each_frame(bytes, [&](const LogFrame&) { return ++frames, true; });
  EXPECT_EQ(frames, 1U);
  EXPECT_EQ(idle, 2U);
}

TEST(ByteWindow, KeepsNoMoreOfALongRecordingThanItLooksAt) {
  char name[] = "/tmp/servoctl-window-XXXXXX";
  const int file = ::mkstemp(name);
  ASSERT_GE(file, 0);
  ::unlink(name);
  std::string piece;
  for (int i = 0; i < 4000; ++i) piece += "(1.000000) can0 581#4B41600037060000\n";
  for (int i = 0; i < 20; ++i)
    ASSERT_EQ(::write(file, piece.data(), piece.size()), static_cast<ssize_t>(piece.size()));
  ASSERT_EQ(::lseek(file, 0, SEEK_SET), 0);
  ByteWindow bytes{Descriptor(file)};
  std::size_t frames = 0;
  std::size_t most = 0;
  (void)for_each_frame(bytes, [&](const LogFrame&) {
    most = std::max(most, bytes.here().size());
    return ++frames, true;
  });
  EXPECT_EQ(frames, 80'000U);
  EXPECT_LT(most, std::size_t{256} << 10U);
}

TEST(ByteWindow, SaysWhyItCannotRead) {
  EXPECT_EQ(open_recording("/nowhere/at/all").error().code, Errc::file);
  EXPECT_EQ(open_recording("/tmp").error().message.text(), "cannot open /tmp: Is a directory");
}

}  // namespace
}  // namespace servoctl::can
