// `test jog`, `test home`, `test all`: what makes them fail, and in which state they leave the drive.
#include <gtest/gtest.h>

#include "drive/standard_objects.hpp"
#include "tested_drive.hpp"
#include "tests/show/audiences.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

using namespace std::chrono_literals;

/// Its limit switches are masked from the factory, by parameters that only the panel shows.
constexpr const char* kSwitchesObeyed = "sv2@1?panel=PA-20=0,PA-74=1";
const std::pair<std::string, std::string> kPanel{"--panel", "PA-20=0,PA-74=1"};

class MotionTests : public TestedDrive {
 protected:
  void TearDown() override {
    EXPECT_FALSE(drive::is_energised(drive().power_state()));
    EXPECT_FALSE(drive().is_moving());
  }
  Result<report::Value> jog(Words more = {}) {
    more.emplace_back("speed", "60rpm");
    return run("test jog", more);
  }
  /// Changes what the drive tells of an object in 4 bytes.
  void distort(ObjectAddress object, std::function<double(double)> change) {
    bus->on_receive = [object, change = std::move(change)](can::Frame& frame) {
      if (frame.id != 0x581 || load_le(std::span(frame.data).subspan(1, 2)) != object.index) return;
      const auto value = static_cast<std::int32_t>(load_le(std::span(frame.data).subspan(4, 4)));
      store_le(static_cast<std::uint64_t>(static_cast<std::int64_t>(change(value))),
               std::span(frame.data).subspan(4, 4));
    };
  }
};

class EveryFamily : public MotionTests, public testing::WithParamInterface<std::string> {};

TEST_P(EveryFamily, PassesTheTestJogAndIsAskedForOnce) {
  build(GetParam() + "@1", GetParam());
  const auto result = jog({{"--turn", "10000"}});
  ASSERT_TRUE(result.has_value()) << result.error().message.text() << result.error().hint.text();
  EXPECT_TRUE(context.errors.empty()) << context.errors.front().message.text();
  EXPECT_EQ(criterion(result, "completed"), "passed \"yes\"");
  EXPECT_TRUE(criterion(result, "direction_backward").starts_with("passed"));
  EXPECT_EQ(questions.size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Families, EveryFamily, testing::Values("da200", "dm", "gsd600", "sv2", "ts"),
                         [](const auto& test) { return test.param; });

TEST_F(MotionTests, JogFailsWhenTheMotorTurnsTheWrongWay) {
  build("sv2@1", "sv2");
  drive().axis_faults().reversed = true;
  const auto result = jog();
  EXPECT_TRUE(criterion(result, "completed").starts_with("failed"));
  EXPECT_TRUE(failed());
}

TEST_F(MotionTests, JogFailsWhenTheMotorIsStalled) {
  build("sv2@1", "sv2");
  drive().axis_faults().stalled = true;
  EXPECT_TRUE(criterion(jog(), "completed").starts_with("failed"));
  EXPECT_TRUE(failed());
}

TEST_F(MotionTests, JogFailsWhenTheSpeedIsOff) {
  build("sv2@1", "sv2");
  distort(objects::kVelocityActual, [](double value) { return value * 0.8; });
  EXPECT_TRUE(criterion(jog(), "speed_forward").starts_with("failed 2"));
  EXPECT_TRUE(criterion(jog({{"--tolerance", "25"}}), "speed_forward").starts_with("passed 2"));
}

TEST_F(MotionTests, JogFailsWhenTheFollowingErrorGrows) {
  build("sv2@1", "sv2");
  distort(objects::kFollowingError, [this](double) { return seconds() * 1000; });
  EXPECT_TRUE(criterion(jog(), "following_error_forward").starts_with("failed"));
  distort(objects::kFollowingError, [](double) { return 500; });
  EXPECT_EQ(criterion(jog(), "following_error_forward"), "passed 0") << "one that stays is no growth";
}

TEST_F(MotionTests, JogFailsWhenItStopsTooLate) {
  build("sv2@1", "sv2");
  EXPECT_TRUE(criterion(jog({{"--stop-within", "100ms"}}), "stop_forward").starts_with("failed"));
  EXPECT_TRUE(criterion(jog(), "stop_backward").starts_with("passed"));
}

TEST_F(MotionTests, JogMovesNothingWithoutAYes) {
  build("sv2@1", "sv2");
  show::Unwilling unwilling;
  context.audience = &unwilling;
  const auto result = jog();
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, Errc::refused);
}

TEST_F(MotionTests, JogShowsItsPlanAndMovesNothingInADryRun) {
  build("sv2@1", "sv2");
  context.dry_run = true;
  const auto result = jog();
  ASSERT_TRUE(result.has_value());
  EXPECT_NE(report::find(*result, "steps"), nullptr);
  EXPECT_TRUE(questions.empty());
}

TEST_F(MotionTests, JogEndsSafelyWhenInterrupted) {
  build("sv2@1", "sv2");
  session->options().cancelled = [this] { return seconds() > 3; };
  const auto result = jog();
  ASSERT_FALSE(context.errors.empty());
  EXPECT_EQ(context.errors.front().code, Errc::interrupted);
}

TEST_F(MotionTests, HomePassesAndShowsEachRun) {
  build(kSwitchesObeyed, "sv2");
  const auto result = run("test home", {{"--repeat", "3"}, {"--limit", "3000rpm"}, kPanel});
  ASSERT_TRUE(result.has_value()) << result.error().message.text() << result.error().hint.text();
  EXPECT_EQ(criterion(result, "found"), "passed 3");
  EXPECT_EQ(criterion(result, "spread"), "passed 0");
  EXPECT_TRUE(context.errors.empty());
}

TEST_F(MotionTests, HomeFailsWhereItEndsSomewhereElseEachTime) {
  build(kSwitchesObeyed, "sv2");
  // The position is true while the motor turns, and another one with each run.
  int runs = 0;
  bool was_energised = false;
  distort({0x6064, 0}, [&, this](double value) {
    const bool is_energised = drive::is_energised(drive().power_state());
    if (is_energised && !was_energised) ++runs;
    was_energised = is_energised;
    return value + runs * 1e5;
  });
  const auto result = run("test home", {{"--repeat", "3"}, {"--limit", "3000rpm"}, kPanel});
  EXPECT_TRUE(criterion(result, "spread").starts_with("failed"));
  EXPECT_TRUE(failed());
}

TEST_F(MotionTests, HomeIsMeasuredAgainstTheEncoderWhichAnIndexPulseFollowsAndASwitchDoesNot) {
  build("cia402@1", "cia402");
  for (const auto& [object, value] : {std::pair(ObjectAddress{0x608F, 1}, 10000U),
                                      {ObjectAddress{0x6092, 1}, 10000U},
                                      {ObjectAddress{0x6099, 1}, 100000U},
                                      {ObjectAddress{0x6099, 2}, 10000U},
                                      {ObjectAddress{0x609A, 0}, 1000000U}})
    ASSERT_TRUE(session->download(1, object, store_le(value, 4)));
  drive().track().scatter = 0.1;  // Turns: 36 degrees.
  const auto home = [&](const std::string& method) {
    return run("test home", {{"method", method}, {"--repeat", "3"}, {"--limit", "3000rpm"}});
  };
  const auto by_switch = home("23");
  EXPECT_EQ(criterion(by_switch, "found"), "passed 3");
  EXPECT_EQ(criterion(by_switch, "spread"), "passed 0");
  EXPECT_EQ(criterion(by_switch, "encoder_spread"), "failed 36");
  const auto by_index = home("7");
  EXPECT_EQ(criterion(by_index, "found"), "passed 3");
  EXPECT_EQ(criterion(by_index, "encoder_spread"), "passed 0");
}

/// A family whose counter is a parameter of its own, in counts that the user tells.
TEST_F(MotionTests, HomeIsMeasuredAgainstTheEncoderOfThePanel) {
  build("gsd600@1", "gsd600");
  for (const auto& [object, value] :
       {std::pair(ObjectAddress{0x6099, 1}, 65536U), {ObjectAddress{0x6099, 2}, 65536U}})
    ASSERT_TRUE(session->download(1, object, store_le(value, 4)));
  drive().track().scatter = 0.1;
  const auto home = [&](const std::string& counts) {
    const Words words{{"method", "19"}, {"--repeat", "3"}, {"--turn", "131072"}, {"--encoder", counts}};
    return criterion(run("test home", words), "encoder_spread");
  };
  EXPECT_TRUE(home("10000").starts_with("failed 3")) << home("10000");
  EXPECT_EQ(criterion(run("test home", {{"method", "19"}, {"--turn", "131072"}}), "encoder_spread"),
            "skipped null");
}

TEST_F(MotionTests, HomeStopsAtTheFirstThatFails) {
  build(kSwitchesObeyed, "sv2");
  drive().track().negative_limit.stuck = true;
  const auto result = run("test home", {{"--limit", "3000rpm"}, kPanel});
  EXPECT_EQ(criterion(result, "found"), "failed 0");
  EXPECT_TRUE(criterion(result, "completed").starts_with("failed"));
}

TEST_F(MotionTests, AllMovesNothingAfterTheCommunicationHasFailed) {
  build("sv2@1", "sv2");
  drive().wire_faults().drop_answers = 1;
  const auto result = run("test all", {{"speed", "60rpm"}});
  EXPECT_EQ(criterion(result, "lost_answers"), "failed 1");
  EXPECT_EQ(criterion(result, "completed"), "none");
  EXPECT_TRUE(questions.empty());
}

/// A limit switch that has just been seen not to work is not driven into.
TEST_F(MotionTests, AllMovesNothingAfterAnInputHasFailed) {
  build(kSwitchesObeyed, "sv2");
  const auto result = run(
      "test all",
      {{"speed", "60rpm"}, {"--limit", "3000rpm"}, {"--expect", "negative-limit"}, {"--for", "1s"}, kPanel});
  EXPECT_EQ(criterion(result, "lost_answers"), "passed 0");
  EXPECT_EQ(criterion(result, "completed"), "none");
  ASSERT_FALSE(context.notices.empty());
  EXPECT_EQ(context.notices.back(), "node 1: nothing was moved, because `test io` failed");
}

/// Its homing speed from the factory is 900 rpm.
TEST_F(MotionTests, AllMovesNothingWhereTheHomingWouldBeRefusedLater) {
  build("sv2@1", "sv2");
  const auto result = run("test all", {{"speed", "60rpm"}});
  EXPECT_EQ(criterion(result, "lost_answers"), "passed 0");
  EXPECT_EQ(criterion(result, "completed"), "none");
  EXPECT_TRUE(questions.empty());
  ASSERT_FALSE(context.errors.empty());
  EXPECT_EQ(context.errors.front().code, Errc::refused);
  EXPECT_TRUE(
      context.errors.front().message.text().starts_with("`test home` cannot be run, so nothing is moved"));
  EXPECT_TRUE(context.errors.front().hint.text().ends_with("add --no-home"))
      << context.errors.front().hint.text();
}

TEST_F(MotionTests, AllRunsEachTest) {
  build(kSwitchesObeyed, "sv2");
  const auto result =
      run("test all", {{"speed", "60rpm"}, {"--repeat", "2"}, {"--limit", "3000rpm"}, kPanel});
  EXPECT_EQ(criterion(result, "lost_answers"), "passed 0");
  EXPECT_TRUE(criterion(result, "direction_forward").starts_with("passed"));
  EXPECT_EQ(criterion(result, "found"), "passed 2");
  EXPECT_TRUE(context.errors.empty());
}

}  // namespace
}  // namespace servoctl::commands
