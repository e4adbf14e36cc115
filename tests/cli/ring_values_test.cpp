// What comes with the process data of a ring is taken from them: by watch, scope and pdo watch.
#include "ring_support.hpp"

namespace servoctl::cli {
namespace {

class RingValues : public RingTest {
 protected:
  void to_op(std::uint8_t node = 1) {
    network().learn(node, rules());
    ASSERT_TRUE(network().request_state(node, NodeState::operational));
  }
};

TEST_F(RingValues, WatchTakesMappedObjectsFromProcessDataAndReadsTheRest) {
  open("sv2@1");
  to_op();
  const auto said = run("watch", {1}, {{"object", "0x6041"}, {"object", "0x6098"}, {"--for", "250ms"}});
  EXPECT_NE(said.find(R"("index":24641,"sub":0,"name":"0x6041:0","samples":3,"by_pdo":3)"), std::string::npos)
      << said << notices();
  EXPECT_NE(said.find(R"("index":24728,"sub":0,"name":"0x6098:0","samples":3,"by_pdo":0)"), std::string::npos)
      << said;
}

TEST_F(RingValues, WatchReadsEverythingBelowSafeOp) {
  open("sv2@1");
  const auto said = run("watch", {1}, {{"object", "0x6041"}, {"--for", "250ms"}});
  EXPECT_NE(said.find(R"("samples":3,"by_pdo":0)"), std::string::npos) << said << notices();
}

TEST_F(RingValues, ScopeTakesTheValueOfEveryCycle) {
  open("sv2@1");
  to_op();
  const auto said = run("scope", {1}, {{"object", "0x6041"}, {"--for", "400ms"}});
  const auto at = said.find(R"("by_pdo":)");
  ASSERT_NE(at, std::string::npos) << said << notices();
  const auto count = std::stoi(said.substr(at + 9));
  EXPECT_GE(count, 98) << said;
  EXPECT_LE(count, 101) << said;
}

TEST_F(RingValues, ScopeReadsAgainWhereTheDriveHasLeftOp) {
  open("sv2@1");
  to_op();
  slave().plan_fall({session_->now() + milliseconds(200), EscState::safe_op, 0x001A});
  const auto said = run("scope", {1}, {{"object", "0x6041"}, {"--for", "800ms"}});
  EXPECT_EQ(context.errors.size(), 0U) << notices();
  const auto samples = said.find(R"("samples":)");
  const auto by_pdo = said.find(R"("by_pdo":)");
  ASSERT_NE(by_pdo, std::string::npos) << said << notices();
  EXPECT_GT(std::stoi(said.substr(by_pdo + 9)), 40) << said;
  EXPECT_GT(std::stoi(said.substr(samples + 10)), std::stoi(said.substr(by_pdo + 9)) + 20) << said;
}

TEST_F(RingValues, PdoWatchShowsThePdosAssignedAndCountsEveryCycle) {
  open("sv2@1");
  to_op();
  const auto said = run("pdo watch", {1}, {{"--for", "400ms"}});
  EXPECT_EQ(context.errors.size(), 0U) << notices();
  for (const auto* pdo : {"RPDO259", "TPDO261"}) {
    const auto at = said.find(pdo);
    ASSERT_NE(at, std::string::npos) << said << notices();
    const auto count = std::stoi(said.substr(said.find(R"("count":)", at) + 8));
    EXPECT_GE(count, 98) << said;
    EXPECT_LE(count, 101) << said;
  }
  EXPECT_EQ(said.find("RPDO258"), std::string::npos) << said;
}

TEST_F(RingValues, PdoWatchShowsNoOutputsThatTheDriveDoesNotTake) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::safe_operational));
  const auto said = run("pdo watch", {1}, {{"--for", "100ms"}});
  EXPECT_NE(said.find(R"("pdo":"RPDO259","count":0)"), std::string::npos) << said << notices();
  EXPECT_EQ(said.find(R"("pdo":"TPDO261","count":0)"), std::string::npos) << said;
}

TEST_F(RingValues, PdoWatchSaysWhatToDoWhereNonePasses) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  EXPECT_EQ(run("pdo watch", {1}, {{"--for", "100ms"}}), "node 1: no PDOs flow: it is in PRE-OP");
  EXPECT_NE(notices().find("`state op -n 1` at the prompt or in a batch file, then `pdo watch`"),
            std::string::npos)
      << notices();
  EXPECT_EQ(slave().state(), EscState::pre_op) << "it is not started, as on CAN";
}

TEST_F(RingValues, PdoWatchTellsThatProcessDataHaveEnded) {
  open("sv2@1");
  to_op();
  slave().plan_fall({session_->now() + milliseconds(200), EscState::safe_op, 0x001A});
  (void)run("pdo watch", {1}, {{"--for", "800ms"}});
  ASSERT_EQ(context.errors.size(), 1U);
  EXPECT_EQ(context.errors.front().message.text(), "node 1: its process data have ended");
}

class RingWithCoupler : public RingTest {
 protected:
  /// By its SII the slave has no mailbox.
  void make_coupler(std::size_t index) {
    auto& sii = slave(index).registers().sii();
    auto content = sii.content();
    std::fill(content.begin() + 0x30, content.begin() + 0x3A, std::uint8_t{0});
    sii.set_content(content);
  }
};

TEST_F(RingWithCoupler, AllNodesAreThoseWithObjectsAndTheOthersAreNamed) {
  open("sv2@1,sv2@2,sv2@3");
  make_coupler(0);
  EXPECT_EQ(session::nodes_present(*session_).value(), (std::vector<std::uint8_t>{2, 3}));
  EXPECT_EQ(network().take_notices(), (std::vector<Message>{"-n all leaves out node 1: no CoE, by its SII"}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(slave(i).state(), EscState::init);
  EXPECT_FALSE(session_->upload(1, objects::kDeviceType)) << "it was named";
  EXPECT_TRUE(session_->upload(2, objects::kDeviceType));
}

TEST_F(RingWithCoupler, ARingOfCouplersAloneHasNoNodesToAsk) {
  open("sv2@1,sv2@2");
  make_coupler(0);
  make_coupler(1);
  const auto none = session::nodes_present(*session_);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Errc::negative);
  EXPECT_EQ(none.error().message.text(), "coe:sim: by their SII none of the 2 slaves has CoE");
}

TEST_F(RingWithCoupler, OneWhoseSiiTellsNothingIsAmongAllNodes) {
  open_with(sim::SiiFault::blank);
  EXPECT_EQ(session::nodes_present(*session_).value(), (std::vector<std::uint8_t>{1}));
  open_with(sim::SiiFault::mute);
  EXPECT_EQ(session::nodes_present(*session_).value(), (std::vector<std::uint8_t>{1}));
}

}  // namespace
}  // namespace servoctl::cli
