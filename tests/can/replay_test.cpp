#include "can/replay.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace servoctl::can {
namespace {

using namespace std::chrono_literals;

class ReplayTest : public testing::Test {
 protected:
  void record(std::string_view text) {
    std::ofstream(path) << text;
    auto opened = open_replay(path.string());
    ASSERT_TRUE(opened) << opened.error().message.text();
    bus = std::move(*opened);
  }
  ~ReplayTest() override { std::filesystem::remove(path); }

  /// What comes within `wait`, or nothing.
  std::string next(Duration wait = 500ms) {
    const auto frame = bus->receive(bus->now() + wait).value();
    return frame ? to_string(*frame) : "";
  }
  bool send(std::string_view frame) { return bus->send(parse_frame(frame).value()).has_value(); }

  std::filesystem::path path =
      std::filesystem::temp_directory_path() /
      (std::string("servoctl-replay-") + testing::UnitTest::GetInstance()->current_test_info()->name());
  std::unique_ptr<Bus> bus;
};

TEST_F(ReplayTest, AnswersAsItWasRecordedInTheRecordingsTime) {
  record(
      "(100.000000) can0 701#00\n(100.500000) can0 601#4041600000000000\n(100.503000) can0 "
      "581#4B41600070020000\n");
  EXPECT_EQ(next(), "701#00");
  EXPECT_EQ(next(), "") << "the answer does not come before the question";
  EXPECT_TRUE(send("601#4041600000000000"));
  EXPECT_EQ(next(), "581#4B41600070020000");
  EXPECT_EQ(bus->now(), TimePoint(100'503ms));
  EXPECT_EQ(next(100ms), "");
  EXPECT_EQ(bus->now(), TimePoint(100'603ms));
}

TEST_F(ReplayTest, HoldsBackWhatCameLaterThanTheDeadline) {
  record("(1.000000) can0 701#00\n(3.000000) can0 701#7F\n");
  EXPECT_EQ(next(), "701#00");
  EXPECT_EQ(next(500ms), "");
  EXPECT_EQ(next(2s), "701#7F");
}

TEST_F(ReplayTest, LetsQuestionsToSeveralNodesComeInAnyOrder) {
  record(
      "(1.0) can0 601#4041600000000000\n(1.1) can0 602#4041600000000000\n(1.2) can0 581#4B41600070020000\n"
      "(1.3) can0 582#4B41600031020000\n");
  EXPECT_TRUE(send("602#4041600000000000"));
  EXPECT_EQ(next(), "");
  EXPECT_TRUE(send("601#4041600000000000"));
  EXPECT_EQ(next(), "581#4B41600070020000");
  EXPECT_EQ(next(), "582#4B41600031020000");
}

TEST_F(ReplayTest, RefusesWhatWasNotSent) {
  record("(1.0) can0 601#4041600000000000\n(1.1) can0 581#4B41600070020000\n");
  EXPECT_FALSE(send("601#2F60600003000000"));
  EXPECT_FALSE(send("581#4B41600070020000"));
  EXPECT_TRUE(send("601#4041600000000000"));
  const auto again = bus->send(parse_frame("601#4041600000000000").value());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, Errc::bus);
  EXPECT_NE(again.error().message.text().find("601#4041600000000000 is not in the rest of the recording"),
            std::string::npos);
}

TEST_F(ReplayTest, SkipsLinesThatAreNoFramesAndRefusesAFileWithoutAny) {
  record("a comment\n(1.0) can0 701#00\r\n\n");
  EXPECT_EQ(next(), "701#00");
  std::ofstream(path) << "nothing\n";
  EXPECT_EQ(open_replay(path.string()).error().code, Errc::file);
  EXPECT_EQ(open_replay("/no/such/file").error().code, Errc::file);
}

TEST_F(ReplayTest, OfSeveralBusesAnswersFromTheOneThatIsNamed) {
  const std::string both =
      "(0.0) can0 601#4000100000000000\n(0.1) can0 581#4300100092010200\n"
      "(0.2) can1 601#4000100000000000\n(0.3) can1 581#4300100034120000\n";
  std::ofstream(path) << both;
  const auto refused = open_replay(path.string());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::usage);
  EXPECT_NE(refused.error().message.text().find("frames of several buses: can0 (2), can1 (2)"),
            std::string::npos);
  EXPECT_NE(refused.error().hint.text().find("?channel=can0"), std::string::npos);
  EXPECT_EQ(open_replay(path.string() + "?channel=can7").error().code, Errc::usage);
  auto opened = open_replay(path.string() + "?channel=can1");
  ASSERT_TRUE(opened) << opened.error().message.text();
  bus = std::move(*opened);
  EXPECT_TRUE(send("601#4000100000000000"));
  EXPECT_EQ(next(), "581#4300100034120000");
  EXPECT_EQ(next(), "");
}

}  // namespace
}  // namespace servoctl::can
