// A node-ID by LSS: what becomes of the slave, and what is refused.
#include "settings/lss_node.hpp"

#include <algorithm>

#include "drive/standard_objects.hpp"
#include "tests/session/lss_world.hpp"

namespace servoctl::settings {
namespace {

using namespace std::chrono_literals;

class LssNode : public session::LssWorld {
 protected:
  /// A drive without LSS that has the number of another.
  sim::SimDrive& add_namesake(std::string_view spec) {
    other = sim::build_cell(spec, kFolders, bus.now()).value();
    bus.attach(*other.drives[0]);
    (void)session->wait([] { return false; }, session->now() + 1s);
    desk.session = session.get();
    return *other.drives[0];
  }
  void energise(std::uint8_t node) {
    for (const auto word : {0x06U, 0x07U, 0x0FU})
      ASSERT_TRUE(session->download(node, objects::kControlword, store_le(word, 2)));
  }
  LssNodeOutcome give(std::uint8_t to, bool keep = false) {
    desk.session = session.get();
    const LssNodeChange change{{}, to, keep};
    const auto slave = look_at_lss_slave(desk, change);
    EXPECT_TRUE(slave) << slave.error().message.text();
    return slave ? give_lss_node(desk, *slave, change) : LssNodeOutcome{};
  }
  show::Desk desk;
  sim::Cell other;
};

TEST_F(LssNode, IsFoundByItWithItsIdentity) {
  build("sv2@255?lss");
  const auto outcome = give(5, true);
  EXPECT_FALSE(outcome.error) << outcome.error->message.text();
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
  EXPECT_NE(outcome.error->message.text().find("its node-ID is the old one again"), std::string::npos)
      << outcome.error->message.text();
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

TEST_F(LssNode, ASlaveThatConfirmsOneAndTakesAnotherIsFound) {
  build("sv2@255?lss");
  hooks.change_request = [](can::Frame& frame) {
    if (frame.data[0] == 0x11 && frame.data[1] == 5) frame.data[1] = 6;
  };
  const auto outcome = give(5);
  ASSERT_TRUE(outcome.error);
  EXPECT_FALSE(outcome.done);
  EXPECT_EQ(outcome.strayed, 6);
  EXPECT_EQ(outcome.error->message.text(),
            "node 6: it has the identity of the LSS slave that confirmed node-ID 5");
}

TEST_F(LssNode, AfterCtrlCNothingIsWritten) {
  build("sv2@255?lss");
  desk.session = session.get();
  const LssNodeChange change{{}, 5, false};
  const auto slave = look_at_lss_slave(desk, change);
  ASSERT_TRUE(slave);
  session->options().cancelled = [] { return true; };
  const auto outcome = give_lss_node(desk, *slave, change);
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.error->code, Errc::interrupted);
  EXPECT_FALSE(outcome.taken);
  session->options().cancelled = {};
  EXPECT_TRUE(cell.drives[0]->node() != 5);
}

TEST_F(LssNode, ASlaveThatAcknowledgesAndDoesNotStartIsTold) {
  build("sv2@255?lss");
  desk.session = session.get();
  const LssNodeChange change{{}, 5, false};
  const auto slave = look_at_lss_slave(desk, change);
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
  EXPECT_FALSE(outcome.error) << outcome.error->message.text();
  EXPECT_EQ(outcome.result, "without a node-ID now");
  EXPECT_TRUE(all_wait());
}

/// Both hear the reset by number.
TEST_F(LssNode, IsNotGivenToOneOfTwoDrivesWhileEitherIsEnergised) {
  for (const bool own : {false, true}) {
    SCOPED_TRACE(own);
    sim::SimBus fresh(sim::SimBus::Clock::virtual_time);
    const auto first = sim::build_cell(own ? "gsd600@1?lss" : "sv2@1?lss", kFolders, fresh.now()).value();
    const auto second = sim::build_cell(own ? "sv2@1" : "gsd600@1", kFolders, fresh.now()).value();
    fresh.attach(own ? *first.drives[0] : *second.drives[0]);
    session = std::make_unique<session::Session>(std::make_unique<session::LssBus>(fresh, hooks), "can0",
                                                 session::Options{});
    desk.session = session.get();
    energise(1);
    (own ? second : first).drives[0]->wire_faults().answer_delay = own ? 0ms : 2ms;
    (own ? first : second).drives[0]->wire_faults().answer_delay = own ? 2ms : 0ms;
    fresh.attach(own ? *second.drives[0] : *first.drives[0]);
    (void)session->wait([] { return false; }, session->now() + 1s);
    const auto slave = look_at_lss_slave(desk, {address(*first.drives[0]), 5, false});
    ASSERT_FALSE(slave);
    EXPECT_EQ(slave.error().code, Errc::refused);
    EXPECT_NE(slave.error().message.text().find("two drives have this node-ID, and one is energised"),
              std::string::npos)
        << slave.error().message.text();
    session.reset();
  }
}

TEST_F(LssNode, IsGivenToOneOfTwoDrivesThatHaveNoPower) {
  build("sv2@1?lss");
  const auto& namesake = add_namesake("gsd600@1");
  const LssNodeChange change{address(*cell.drives[0]), 5, false};
  const auto slave = look_at_lss_slave(desk, change);
  ASSERT_TRUE(slave) << slave.error().message.text();
  EXPECT_NE(shared_lss_node(*session, *slave), "") << "the question names it";
  const auto outcome = give_lss_node(desk, *slave, change);
  EXPECT_EQ(outcome.result, "moved") << (outcome.error ? outcome.error->message.text() : "");
  EXPECT_EQ(cell.drives[0]->node(), 5);
  EXPECT_EQ(namesake.node(), 1);
  ASSERT_EQ(desk.notices.size(), 1U) << "it is told, where nobody was asked, too";
  EXPECT_TRUE(
      desk.notices.front().text().starts_with("node 1: the other drive of this node-ID was reset as well"));
}

TEST_F(LssNode, IsTakenFromOneOfTwoDrives) {
  build("sv2@1?lss");
  (void)add_namesake("gsd600@1");
  const LssNodeChange change{address(*cell.drives[0]), canopen::kUnconfigured, false};
  const auto slave = look_at_lss_slave(desk, change);
  ASSERT_TRUE(slave) << slave.error().message.text();
  const auto outcome = give_lss_node(desk, *slave, change);
  EXPECT_EQ(outcome.result, "without a node-ID now") << "the other one keeps its own";
  EXPECT_TRUE(outcome.done);
}

TEST_F(LssNode, ThatItHasAlreadyIsNothingToDo) {
  build("sv2@5?lss");
  energise(5);
  const auto boots = session->watch().boots(5);
  const auto outcome = give(5);
  EXPECT_EQ(outcome.result, "nothing to do");
  EXPECT_FALSE(outcome.error);
  (void)session->wait([] { return false; }, session->now() + 1s);
  EXPECT_EQ(session->watch().boots(5), boots);
}

TEST_F(LssNode, ThatItHasAlreadyIsStoredWithoutAReset) {
  build("sv2@5?lss");
  const auto boots = session->watch().boots(5);
  const auto outcome = give(5, true);
  EXPECT_EQ(outcome.result, "stored");
  EXPECT_EQ(outcome.kept, true);
  (void)session->wait([] { return false; }, session->now() + 1s);
  EXPECT_EQ(session->watch().boots(5), boots);
}

TEST_F(LssNode, WhoseStoringIsNotAnsweredIsNotKnown) {
  build("sv2@3?lss");
  hooks.change_answer = [](can::Frame& frame) {
    if (frame.data[0] == 0x17) frame.data[0] = 0;
  };
  const auto outcome = give(7, true);
  ASSERT_TRUE(outcome.error);
  EXPECT_EQ(outcome.result, "not known");
  EXPECT_FALSE(outcome.kept.has_value());
  EXPECT_NE(outcome.error->message.text().find("which of them it has after power-off is not known"),
            std::string::npos)
      << outcome.error->message.text();
}

TEST_F(LssNode, ThatSomebodyUsesIsRefusedBeforeAnythingIsSet) {
  build("sv2@3,gsd600@7?lss");
  desk.session = session.get();
  std::vector<std::uint8_t> services;
  const LssNodeChange change{address(*cell.drives[0]), 7, false};
  const auto slave = look_at_lss_slave(desk, change);
  ASSERT_FALSE(slave);
  EXPECT_EQ(slave.error().code, Errc::refused);
  EXPECT_TRUE(all_wait());
}

}  // namespace
}  // namespace servoctl::settings
