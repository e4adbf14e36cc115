// Drives whose master is gone, as `gateway` stops them.
#include "motion/abandoned.hpp"

#include "command/context.hpp"
#include "motion/power.hpp"
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

using drive::DriveState;

class Abandoned : public testing::Test {
 protected:
  /// The errors of the line that stops node 1.
  const std::vector<Error>& stop() {
    EXPECT_TRUE(Power(*bench.session, bench.profile(), 1).reach(DriveState::operation_enabled));
    bench.session->energised().insert(1);
    if (enabled) enabled();
    desk.session = bench.session.get();
    stop_abandoned(desk, {1});
    return desk.errors;
  }

  MotionBench bench{"gsd600"};
  command::Context desk;
  std::function<void()> enabled;
};

TEST_F(Abandoned, ADriveThatObeysIsNoError) {
  EXPECT_TRUE(stop().empty());
  EXPECT_FALSE(bench.energised());
}

TEST_F(Abandoned, ADriveThatEndsInFaultInsteadOfObeyingIsAnError) {
  bench.bus->alter = [&](can::Frame& frame) {
    const bool takes_stop = frame.id == 0x581 && frame.data[0] == 0x60 && frame.data[1] == 0x40;
    if (takes_stop && bench.drive().power_state() == DriveState::quick_stop_active)
      bench.drive().raise_fault(0x8611, {}, bench.session->now());
  };
  const auto& errors = stop();
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_NE(errors[0].message.text().find("de-energised now, but in fault"), std::string::npos)
      << errors[0].message.text();
}

TEST_F(Abandoned, ADriveThatFallsSilentIsAnError) {
  enabled = [&] { bench.drive().wire_faults().silent = true; };
  const auto& errors = stop();
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_TRUE(errors[0].message.text().starts_with("NODE 1 MAY STILL BE ENERGISED"))
      << errors[0].message.text();
}

TEST_F(Abandoned, ADriveThatAbortsTheStopIsAnError) {
  enabled = [&] { bench.drive().wire_faults().no_stop = true; };
  const auto& errors = stop();
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_TRUE(errors[0].message.text().starts_with("NODE 1 MAY STILL BE ENERGISED"))
      << errors[0].message.text();
}

}  // namespace
}  // namespace servoctl::motion
