// Ways down on a network that is no CAN bus.
#include <gtest/gtest.h>

#include "drive/standard_objects.hpp"
#include "motion/power_down.hpp"
#include "motion/producer_claim.hpp"
#include "tests/session/memory_network.hpp"
#include "tests/session/memory_objects.hpp"

namespace servoctl::motion {
namespace {

using session::NodeState;

/// A drive that is enabled no more, in memory.
class WayDown : public testing::Test {
 protected:
  WayDown() {
    auto owned = std::make_unique<session::MemoryNetwork>();
    objects.values = {{servoctl::objects::kStatusword, {0x50, 0x02}},
                      {servoctl::objects::kControlword, {0x06, 0x00}}};
    objects.read_only.insert(servoctl::objects::kStatusword);
    node = &owned->add(1, objects);
    session.emplace(std::move(owned), "memory", session::Options{});
  }

  session::MemoryObjects objects;
  session::MemoryNode* node = nullptr;
  std::optional<session::Session> session;
};

TEST_F(WayDown, TakesADriveDown) {
  std::vector<PowerDownPlan> plans(1);
  plans[0].node = 1;
  const auto done = motion::take_down(*session, std::move(plans)).front();
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_TRUE(done.is_without_power());
  EXPECT_EQ(objects.values[servoctl::objects::kControlword], (Bytes{0, 0}));
}

TEST_F(WayDown, WakesADriveThatIsStoppedOnItsWayDown) {
  node->state = NodeState::stopped;
  std::vector<PowerDownPlan> plans(1);
  plans[0].node = 1;
  const auto done = motion::take_down(*session, std::move(plans)).front();
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_EQ(node->state, NodeState::pre_operational);
  EXPECT_EQ(objects.values[servoctl::objects::kControlword], (Bytes{0, 0}));
}

TEST_F(WayDown, NobodyContestsTheNumberOfTheProducerWhereThereIsNone) {
  WatchdogPlan plan;
  plan.kind = WatchdogPlan::Kind::heartbeat;
  plan.producer = 127;
  EXPECT_TRUE(claim_producer(*session, 1, std::nullopt, plan));
  EXPECT_TRUE(check_producer(*session));
}

TEST(PlannedPowerDown, NamesAStateAndNoFrame) {
  const auto planned = planned_power_down(5, PowerAim::stop_and_disable);
  ASSERT_FALSE(planned.empty());
  EXPECT_EQ(planned.back().state, NodeState::pre_operational);
  EXPECT_FALSE(planned.back().write);
}

}  // namespace
}  // namespace servoctl::motion
