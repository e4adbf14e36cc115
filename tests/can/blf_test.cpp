// Vector publishes no description; the layout is that of python-can (can/io/blf.py) and of Vector BLF by T.
// Lorenz.
#include "can/blf.hpp"

#include <gtest/gtest.h>

#include "can/unpack.hpp"
#include "tests/can/recording_bytes.hpp"

namespace servoctl::can {
namespace {

using Log = std::vector<std::string>;

std::string blf_head() { return FileBytes().text("LOGG").u32(144).zeros(136).str(); }

/// An object with the first form of header: flags 2 are nanoseconds, 1 tens of microseconds.
std::string object(std::uint32_t type, const std::string& body, std::uint64_t time = 1'500'000'000,
                   std::uint32_t flags = 2) {
  return FileBytes()
      .text("LOBJ")
      .u16(32)
      .u16(1)
      .u32(32 + body.size())
      .u32(type)
      .u32(flags)
      .u16(0)
      .u16(0)
      .u64(time)
      .text(body)
      .str();
}

std::string message(std::uint16_t channel, int flags, int size, std::uint32_t id, const std::string& data) {
  return FileBytes().u16(channel).bytes({flags, size}).u32(id).text(data).zeros(8 - data.size()).str();
}

const std::string kRequest = FileBytes().bytes({0x40, 0x41, 0x60, 0, 0, 0, 0, 0}).str();

/// What zlib unpacks to `data`, without compression: RFC 1950 and 1951, stored blocks.
std::string stored(const std::string& data) {
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const char byte : data) {
    a = (a + static_cast<std::uint8_t>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  return FileBytes().bytes({0x78, 0x01, 0x01}).u16(data.size()).u16(~data.size() & 0xFFFFU).text(data).str() +
         FileBytes(true).u32(b << 16U | a).str();
}

std::string container(int method, const std::string& packed, std::size_t unpacked) {
  const auto size = 32 + packed.size();
  return FileBytes()
      .text("LOBJ")
      .u16(16)
      .u16(1)
      .u32(size)
      .u32(10)
      .u16(static_cast<std::uint16_t>(method))
      .zeros(6)
      .u32(unpacked)
      .zeros(4)
      .text(packed)
      .zeros(size % 4)
      .str();
}

std::string packed(const std::string& data) { return container(2, stored(data), data.size()); }

TEST(Unpack, TakesWhatZlibPackedAndNoMoreThanIsAllowed) {
  EXPECT_EQ(unpack(stored("abc"), 3).bytes, "abc");
  EXPECT_TRUE(unpack(stored("abc"), 3).whole);
  EXPECT_FALSE(unpack(stored("abc"), 2).whole);
  EXPECT_EQ(unpack(stored("abc"), 2).bytes, "ab");
  EXPECT_FALSE(unpack(stored("abc").substr(0, 8), 3).whole) << "cut short";
  EXPECT_EQ(unpack(stored("abc").substr(0, 8), 3).bytes, "a");
  auto wrong = stored("abc");
  wrong.back() = static_cast<char>(wrong.back() ^ 1);
  EXPECT_FALSE(unpack(wrong, 3).whole) << "checksum";
  EXPECT_FALSE(unpack("", 3).whole);
}

TEST(Blf, ReadsFramesOfBothTypesPackedOrNot) {
  const auto objects = object(1, message(1, 0, 8, 0x601, kRequest)) +
                       object(86, message(2, 1, 2, 0x8000'0123, "\x01\x02") + std::string(8, '\0')) +
                       object(1, message(1, 0x80, 1, 0x701, ""), 150'000, 1);
  const Log expected{"(0000000001.500000) can1 601#4041600000000000",
                     "(0000000001.500000) can2 00000123#0102", "(0000000001.500000) can1 701#R1"};
  EXPECT_EQ(frames_of(blf_head() + packed(objects)), expected);
  EXPECT_EQ(frames_of(blf_head() + container(0, objects, objects.size())), expected);
  EXPECT_EQ(frames_of(blf_head() + objects), expected) << "without a container";
}

TEST(Blf, AnObjectGoesOnInTheNextContainer) {
  const auto objects =
      object(1, message(1, 0, 8, 0x601, kRequest)) + object(1, message(1, 0, 1, 0x602, "\x07"));
  for (std::size_t cut = 1; cut < objects.size(); ++cut)
    EXPECT_EQ(frames_of(blf_head() + packed(objects.substr(0, cut)) + packed(objects.substr(cut))),
              (Log{"(0000000001.500000) can1 601#4041600000000000", "(0000000001.500000) can1 602#07"}))
        << cut;
}

TEST(Blf, ReadsErrorFramesAndTheSecondFormOfHeader) {
  const auto body = message(3, 0, 1, 0x603, "\x09");
  const auto second = FileBytes()
                          .text("LOBJ")
                          .u16(40)
                          .u16(2)
                          .u32(40 + body.size())
                          .u32(1)
                          .u32(2)
                          .bytes({0, 0})
                          .u16(0)
                          .u64(2'000'001'000)
                          .u64(0)
                          .text(body)
                          .str();
  const auto error = object(73, FileBytes().u16(1).zeros(34).str());
  EXPECT_EQ(frames_of(blf_head() + packed(second + error)),
            (Log{"(0000000002.000001) can3 603#09", "(0000000001.500000) can1 20000008#0000000000000000"}));
}

TEST(Blf, ClassicalFramesOfFdChannelsAreReadAndFdFramesAreNot) {
  const auto fd = [](int fd_flags) {
    return object(100, FileBytes()
                           .u16(1)
                           .bytes({0, 2})
                           .u32(0x181)
                           .u32(0)
                           .bytes({0, fd_flags, 2})
                           .zeros(5)
                           .bytes({1, 2})
                           .zeros(62)
                           .str());
  };
  const auto fd64 = [](std::uint32_t flags, int code, int size) {
    return object(
        101,
        FileBytes().bytes({2, code, size, 0}).u32(0x182).u32(0).u32(flags).zeros(24).bytes({3, 4}).str());
  };
  EXPECT_EQ(
      frames_of(blf_head() + packed(fd(0) + fd(1) + fd64(0, 2, 2) + fd64(0x1000, 2, 2) + fd64(0x10, 2, 0))),
      (Log{"(0000000001.500000) can1 181#0102", "(0000000001.500000) can2 182#0304",
           "(0000000001.500000) can2 182#R2", "unsuited 2"}));
}

TEST(Blf, OtherObjectsArePassedOverAndPaddingIsKnown) {
  const auto text = object(65, "text!");  // Its size asks for padding.
  EXPECT_EQ(frames_of(blf_head() +
                      packed(text + std::string(1, '\0') + object(1, message(1, 0, 1, 0x601, "\x05")))),
            (Log{"(0000000001.500000) can1 601#05"}));
}

TEST(Blf, AFileThatIsCutGivesWhatIsInFrontOfIt) {
  const auto first = packed(object(1, message(1, 0, 1, 0x601, "\x05")));
  const auto all = blf_head() + first + packed(object(1, message(1, 0, 1, 0x602, "\x06")));
  const auto begin = blf_head().size() + first.size();
  for (auto size = begin + 1; size < all.size() - 3; ++size) {
    const auto read = frames_of(std::string_view(all).substr(0, size));
    ASSERT_GE(read.size(), 2U) << size;
    EXPECT_EQ(read[0], "(0000000001.500000) can1 601#05");
    EXPECT_TRUE(read.back().starts_with("damage at " + std::to_string(begin))) << read.back();
  }
  EXPECT_EQ(frames_of("LOGG").back(), "damage at 0: its header is cut short");
  const auto half = object(1, message(1, 0, 1, 0x601, "\x05")).substr(0, 40);
  EXPECT_TRUE(frames_of(blf_head() + packed(half)).back().ends_with("its last object is cut short"));
}

TEST(Blf, WhatWasPackedInFrontOfACutIsRead) {
  const auto all =
      packed(object(1, message(1, 0, 1, 0x601, "\x05")) + object(1, message(1, 0, 1, 0x602, "\x06")));
  const auto read = frames_of(blf_head() + all.substr(0, 32 + 7 + 48 + 20));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0], "(0000000001.500000) can1 601#05");
  EXPECT_TRUE(read[1].starts_with("damage at 144: an object of")) << read[1];
}

TEST(Blf, WhatUnpacksToMoreThanItSaysIsRefused) {
  const auto data = object(1, message(1, 0, 1, 0x601, "\x05"));
  const auto bomb = container(2, stored(data), data.size() - 1);
  EXPECT_EQ(frames_of(blf_head() + bomb),
            (Log{"damage at 144: the container there is damaged, or holds more than it says"}));
}

TEST(Blf, HostileLengthsAreToldWithTheirPlace) {
  const auto hostile = [](std::uint32_t size) {
    return FileBytes().text("LOBJ").u16(32).u16(1).u32(size).u32(1).zeros(32).str();
  };
  for (const std::uint32_t size : {0U, 15U, 0xFFFF'FFFFU}) {
    EXPECT_TRUE(frames_of(blf_head() + hostile(size)).back().starts_with("damage at 144: an object of"))
        << size;
    EXPECT_TRUE(frames_of(blf_head() + packed(hostile(size)))
                    .back()
                    .starts_with("damage at 144: the container there holds"))
        << size;
  }
  EXPECT_EQ(frames_of(blf_head() + std::string(40, 'x')), (Log{"damage at 144: no object begins there"}));
  EXPECT_EQ(frames_of(blf_head() + container(7, "abc", 3)),
            (Log{"damage at 144: a container of an unknown kind (7) begins there"}));
}

TEST(Blf, ASmallObjectOfATypeThatIsReadIsNoFrame) {
  EXPECT_EQ(frames_of(blf_head() + packed(object(1, "ab") + object(73, ""))), (Log{"unknown 2 at 1"}));
}

}  // namespace
}  // namespace servoctl::can
