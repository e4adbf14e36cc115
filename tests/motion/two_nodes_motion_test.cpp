// A second node of the same number that turns up in the middle of a motion.
#include "motion/motion_result.hpp"
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

/// Answers to what a motion looks at: statusword, position, speed.
bool is_looked_at(const can::Frame& frame) {
  const auto index = static_cast<unsigned>(frame.data[1] | frame.data[2] << 8U);
  return frame.id == 0x581 && frame.data[0] >> 5U == 2 &&
         (index == 0x6041 || index == 0x6064 || index == 0x606C);
}

TEST_F(MotionTrouble, ASecondNodeOfItsNumberStopsTheMotion) {
  const auto begin = bench.session->now() + std::chrono::seconds(1);
  bench.bus->alter = [&](can::Frame& frame) {
    if (bench.session->now() > begin && is_looked_at(frame))
      bench.bus->injected.push_back(can::to_string(frame));
  };
  const auto done = bench.jog(kJog);
  ASSERT_FALSE(done.outcome);
  EXPECT_NE(done.outcome.error().message.text().find("two nodes answer with this node-ID"), std::string::npos)
      << done.outcome.error().message.text();
  EXPECT_FALSE(done.end.verified) << "which of two is without power is not known";
  const auto text = end_text(done.end, done.watchdog);
  EXPECT_EQ(text.find("watchdog"), std::string::npos) << "it was taken back: " << text;
  EXPECT_FALSE(bench.energised());
  EXPECT_EQ(bench.changed(), std::vector<std::string>{});
  EXPECT_EQ(done.outcome.error().code, Errc::refused);
  EXPECT_LT(bench.session->now() - begin, std::chrono::seconds(3));
}

TEST_F(MotionTrouble, DoubledFramesNowAndThenStopNoMotion) {
  int seen = 0;
  bench.bus->alter = [&](can::Frame& frame) {
    if (is_looked_at(frame) && ++seen % 10 == 0) bench.bus->injected.push_back(can::to_string(frame));
  };
  const auto done = bench.jog(jog_for("60rpm", std::chrono::milliseconds(500)));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_GT(seen, 20);
}

}  // namespace
}  // namespace servoctl::motion
