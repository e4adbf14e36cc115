#include "can/frame.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace servoctl::can {
namespace {

Frame remote(std::uint32_t id, std::uint8_t size) {
  Frame frame;
  frame.id = id;
  frame.size = size;
  frame.remote = true;
  return frame;
}

Frame any_frame() {
  Frame frame;
  frame.error = *rc::gen::arbitrary<bool>();
  frame.extended = !frame.error && *rc::gen::arbitrary<bool>();
  frame.remote = !frame.error && *rc::gen::arbitrary<bool>();
  const bool long_id = frame.error || frame.extended;
  frame.id = *rc::gen::inRange<std::uint32_t>(0, long_id ? 0x2000'0000U : 0x800U);
  frame.size = *rc::gen::inRange<std::uint8_t>(0, 9);
  if (frame.remote) return frame;
  const auto bytes =
      *rc::gen::container<std::vector<std::uint8_t>>(frame.size, rc::gen::arbitrary<std::uint8_t>());
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return frame;
}

TEST(Frame, IsWrittenAsCanUtilsWriteIt) {
  const std::vector<std::uint8_t> data{0x40, 0x41, 0x60, 0x00, 0xAB};
  EXPECT_EQ(to_string(make_frame(0x601, data)), "601#40416000AB");
  EXPECT_EQ(to_string(make_frame(0x80, {})), "080#");
  EXPECT_EQ(to_string(remote(0x701, 0)), "701#R");
  EXPECT_EQ(to_string(remote(0x181, 8)), "181#R8");
}

TEST(Frame, With29BitsIsWrittenWithEightDigits) {
  auto frame = make_frame(0x123, std::vector<std::uint8_t>{0});
  frame.extended = true;
  EXPECT_EQ(to_string(frame), "00000123#00");
}

TEST(Frame, ThatReportsTheControllerCarriesTheErrorFlagInItsIdentifier) {
  Frame bus_off;
  bus_off.error = true;
  bus_off.id = 0x40;
  bus_off.size = 8;
  EXPECT_EQ(to_string(bus_off), "20000040#0000000000000000");
  EXPECT_EQ(parse_frame("20000040#0000000000000000"), bus_off);
}

TEST(Frame, TakesNoMoreThanEightBytes) {
  EXPECT_EQ(to_string(make_frame(1, std::vector<std::uint8_t>(9, 0x11))), "001#1111111111111111");
}

TEST(Frame, OfARemoteRequestHasNoPayload) { EXPECT_TRUE(remote(0x701, 4).payload().empty()); }

TEST(Frame, IsReadInLowerCaseAndWithLeadingZeros) {
  EXPECT_EQ(parse_frame("0ab#cdef"), make_frame(0xAB, std::vector<std::uint8_t>{0xCD, 0xEF}));
  EXPECT_EQ(parse_frame("701#r"), remote(0x701, 0));
}

TEST(Frame, IsRefusedWhenTheTextIsNotOne) {
  for (const auto* text :
       {"", "#", "601", "601#4", "601#4G", "60#00", "0601#00", "800#00", "601#R9", "601#R1x", "601#R02",
        "601##100", "601#112233445566778899", "40000000#00", "-01#00", "6 1#00"})
    EXPECT_EQ(parse_frame(text), std::nullopt) << text;
}

RC_GTEST_PROP(Frame, SurvivesBeingWrittenAndRead, ()) {
  const auto frame = any_frame();
  RC_ASSERT(parse_frame(to_string(frame)) == frame);
}

RC_GTEST_PROP(Frame, IsNeverReadFromTextThatWouldBeWrittenOtherwise, ()) {
  const auto text = *rc::gen::container<std::string>(rc::gen::elementOf(std::string("0127F#Rr")));
  const auto frame = parse_frame(text);
  if (!frame) return;
  auto upper = to_string(*frame);
  auto given = text;
  std::replace(given.begin(), given.end(), 'r', 'R');
  if (given.ends_with("R0")) given.pop_back();
  RC_ASSERT(upper == given);
}

}  // namespace
}  // namespace servoctl::can
