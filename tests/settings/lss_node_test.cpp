// A node-ID by LSS: what becomes of the slave, and what is refused.
#include "settings/lss_node.hpp"

#include <algorithm>

#include "tests/session/lss_world.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

class LssNode : public session::LssWorld {
 protected:
  LssNodeOutcome give(std::uint8_t to, bool keep = false) {
    desk.session = session.get();
    const LssNodeChange change{{}, to, keep};
    const auto slave = look_at_lss_slave(*session, change);
    EXPECT_TRUE(slave) << slave.error().message;
    return slave ? give_lss_node(desk, *slave, change) : LssNodeOutcome{};
  }
  show::Desk desk;
};

TEST_F(LssNode, IsFoundByItWithItsIdentity) {
  build("sv2@255?lss");
  const auto outcome = give(5, true);
  EXPECT_FALSE(outcome.error) << outcome.error->message;
  EXPECT_TRUE(outcome.done && outcome.taken);
  EXPECT_EQ(outcome.kept, true);
  EXPECT_EQ(cell.drives[0]->node(), 5);
  EXPECT_TRUE(all_wait());
}

TEST_F(LssNode, OfAConfiguredSlaveHoldsWithItsReset) {
  build("sv2@3?lss");
  const auto outcome = give(7);
  EXPECT_FALSE(outcome.error);
  EXPECT_EQ(outcome.result, "moved");
  EXPECT_FALSE(outcome.kept);
  EXPECT_EQ(cell.drives[0]->node(), 7);
}

TEST_F(LssNode, IsTheOldOneAgainWhereStoringFails) {
  build("sv2@3?lss");
  hooks.change_answer = [](can::Frame& frame) {
    if (frame.data[0] == 0x17) frame.data[1] = 2;
  };
  const auto outcome = give(7, true);
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.result, "not changed");
  EXPECT_EQ(outcome.kept, false);
  EXPECT_NE(outcome.error->message.find("its node-ID is the old one again"), std::string::npos)
      << outcome.error->message;
  EXPECT_TRUE(all_wait());
  (void)bus.send(*can::parse_frame("000#8203"));
  (void)session->wait([] { return false; }, session->now() + 1s);
  EXPECT_EQ(cell.drives[0]->node(), 3);
}

TEST_F(LssNode, ThatIsNotTakenLeavesTheSlaveAsItWas) {
  build("sv2@3?lss");
  hooks.change_answer = [](can::Frame& frame) {
    if (frame.data[0] == 0x11) frame.data[1] = 1;
  };
  const auto outcome = give(7);
  ASSERT_TRUE(outcome.error);
  EXPECT_FALSE(outcome.taken);
  EXPECT_EQ(outcome.result, "not changed");
  EXPECT_EQ(cell.drives[0]->node(), 3);
}

TEST_F(LssNode, ASlaveThatAcknowledgesAndDoesNotStartIsTold) {
  build("sv2@255?lss");
  desk.session = session.get();
  const LssNodeChange change{{}, 5, false};
  const auto slave = look_at_lss_slave(*session, change);
  ASSERT_TRUE(slave);
  hooks.change_answer = [&](can::Frame& frame) {
    if (frame.data[0] == 0x11) cell.drives[0]->wire_faults().silent = true;
  };
  const auto outcome = give_lss_node(desk, *slave, change);
  ASSERT_TRUE(outcome.error);
  EXPECT_TRUE(outcome.taken);
  EXPECT_FALSE(outcome.done);
  EXPECT_EQ(outcome.result, "set; not found");
}

/// CANopenNode's slaves do not know the question for those without a node-ID.
TEST_F(LssNode, ThatIsTakenAwayIsSeenInASlaveThatDoesNotSayThatItHasNone) {
  build("sv2@3?lss");
  hooks.change_answer = [](can::Frame& frame) {
    if (frame.data[0] == 0x50) frame.data[0] = 0;
  };
  const auto outcome = give(canopen::kUnconfigured);
  EXPECT_FALSE(outcome.error) << outcome.error->message;
  EXPECT_EQ(outcome.result, "without a node-ID now");
  EXPECT_TRUE(all_wait());
}

TEST_F(LssNode, ThatSomebodyUsesIsRefusedBeforeAnythingIsSet) {
  build("sv2@3,gsd600@7?lss");
  std::vector<std::uint8_t> services;
  const LssNodeChange change{address(*cell.drives[0]), 7, false};
  const auto slave = look_at_lss_slave(*session, change);
  ASSERT_FALSE(slave);
  EXPECT_EQ(slave.error().code, Errc::refused);
  EXPECT_TRUE(all_wait());
}

}  // namespace
}  // namespace servoctl::settings
