#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "can/trace.hpp"

namespace servoctl::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

Frame frame_in(const char* text) { return parse_frame(text).value(); }

TEST(LogLine, IsReadAsCandumpWritesIt) {
  const auto line = parse_log_line("(1736412345.123456) vcan0 601#4041600000000000\r\n");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->time, microseconds(1'736'412'345'123'456));
  EXPECT_EQ(line->interface_name, "vcan0");
  EXPECT_EQ(line->frame, frame_in("601#4041600000000000"));
}

TEST(LogLine, IsReadWithDirectionNanosecondsAndMoreSpaces) {
  const auto line = parse_log_line(" (0000000001.500000999)  can0   701#R  T");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->time, microseconds(1'500'000));
  EXPECT_EQ(line->frame, frame_in("701#R"));
  EXPECT_TRUE(parse_log_line("(1.5) can0 080# R"));
  EXPECT_EQ(parse_log_line("(1.5) can0 080#")->time, milliseconds(1500));
}

TEST(LogLine, IsRefusedWhenItIsSomethingElse) {
  for (const auto* text :
       {"", "can0 080#", "(1.0) can0", "(1.0) can0 080# X", "(1.0) can0 080# R R", "1.0 can0 080#",
        "(1) can0 080#", "(.5) can0 080#", "(1.) can0 080#", "(1.0000000000) can0 080#", "(-1.0) can0 080#",
        "(1.0) can0 123##10", "(9999999999999.0) can0 080#", "() can0 080#", "( can0 080#", "(1.0)can0 080#",
        "# (1.0) can0 080#"})
    EXPECT_EQ(parse_log_line(text), std::nullopt) << text;
}

RC_GTEST_PROP(LogLine, SurvivesBeingWrittenAndRead, ()) {
  LogFrame line;
  line.time = microseconds(*rc::gen::inRange<std::int64_t>(0, 4'000'000'000'000'000));
  line.interface_name = "can1";
  line.frame = make_frame(*rc::gen::inRange<std::uint32_t>(0, 0x800),
                          *rc::gen::arbitrary<std::vector<std::uint8_t>>());
  RC_ASSERT(parse_log_line(to_string(line)) == line);
}

RC_GTEST_PROP(LogLine, NeverMakesTheReaderFail, ()) {
  parse_log_line(*rc::gen::container<std::string>(rc::gen::elementOf(std::string("(1.) can#R\n\xff"))));
}

}  // namespace
}  // namespace servoctl::can
