// How long the mapping of a drive holds as it was read: TPDOs are taken apart by it until then, and not
// longer.
#include "session/process_values.hpp"

#include <gtest/gtest.h>

#include "canopen/pdo.hpp"
#include "scripted_bus.hpp"
#include "session/can_network.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

constexpr ObjectAddress kTorque{0x6077, 0};

class TpdoValuesTest : public testing::Test {
 protected:
  TpdoValuesTest() {
    auto owned = std::make_unique<ScriptedBus>();
    bus = owned.get();
    session.emplace(std::move(owned), "can9", Options{});
    canopen::Pdo pdo{canopen::PdoDirection::transmit, 1, 0x4000'0185};
    pdo.entries = {{kTorque, 16}};
    session->can()->learn_pdos(5, {pdo}, session->can()->epoch(5));
    lifetime.emplace(*session, 5);
    values = session->network().process_values(5, std::span(&kTorque, 1));
    values->keep_all();
  }
  void pass(Duration time) {
    (void)session->wait([] { return false; }, session->now() + time);
  }
  /// A TPDO comes, and whether it gives a value.
  bool brings() {
    const auto since = session->now();
    bus->arrive("185#3702", 1ms);
    pass(2ms);
    const bool any = values->take(kTorque, since).has_value();
    EXPECT_EQ(values->take_all().size(), any ? 1U : 0U);
    return any;
  }
  /// What arrives ends it, for this reason.
  void ends_by(const std::vector<std::string>& frames, const std::string& why) {
    ASSERT_TRUE(brings());
    for (const auto& frame : frames) bus->arrive(frame, 1ms);
    pass(10ms);
    EXPECT_FALSE(brings());
    EXPECT_FALSE(values->carries(kTorque));
    EXPECT_EQ(session->can()->known_pdos(5), nullptr);
    EXPECT_EQ(lifetime->ended(), why);
  }
  void goes_on_after(const std::vector<std::string>& frames) {
    for (const auto& frame : frames) bus->arrive(frame, 1ms);
    pass(10ms);
    EXPECT_TRUE(brings());
    EXPECT_EQ(lifetime->ended(), "");
  }

  ScriptedBus* bus = nullptr;
  std::optional<Session> session;
  std::optional<Lifetime> lifetime;
  std::unique_ptr<ProcessValues> values;
};

TEST_F(TpdoValuesTest, ABootUpEndsTheMapping) { ends_by({"705#00"}, "has restarted"); }
TEST_F(TpdoValuesTest, AResetByAnotherMasterEndsTheMapping) { ends_by({"000#8105"}, "was reset (NMT)"); }
TEST_F(TpdoValuesTest, AResetOfTheCommunicationOfAllEndsTheMapping) {
  ends_by({"000#8200"}, "was reset (NMT)");
}
TEST_F(TpdoValuesTest, AMappingThatAnotherMasterWritesEndsTheMapping) {
  ends_by({"605#23001A0110007760"}, "has another PDO setting: object 0x1A00:1 was written");
}
TEST_F(TpdoValuesTest, ACobIdThatAnotherMasterWritesByBlockEndsTheMapping) {
  ends_by({"605#C200180104000000"}, "has another PDO setting: object 0x1800:1 was written");
}
TEST_F(TpdoValuesTest, ALostHeartbeatEndsTheMapping) {
  for (int i = 1; i <= 3; ++i) bus->arrive("705#05", i * 100ms);
  pass(350ms);
  EXPECT_TRUE(brings());
  pass(1s);
  EXPECT_FALSE(brings());
  EXPECT_EQ(lifetime->ended(), "was lost");
  EXPECT_FALSE(session->watch().state(5)) << "it is not known any more";
}
TEST_F(TpdoValuesTest, ABusThatWasAwayEndsTheMapping) {
  bus->lose(session->now() + 1ms, session->now() + 2ms);
  pass(5ms);
  ASSERT_TRUE(session->network().recover(session->now() + 10ms));
  EXPECT_FALSE(brings());
  EXPECT_EQ(lifetime->ended(), "was not heard while the bus was away");
}
TEST_F(TpdoValuesTest, AWriteOfThisProgramEndsTheMapping) {
  session->options().timeout = 5ms;
  (void)session->download(5, {0x1A00, 0}, {0});
  EXPECT_FALSE(brings());
  EXPECT_EQ(lifetime->ended(), "has another PDO setting: object 0x1A00:0 was written");
}

TEST_F(TpdoValuesTest, WhatConcernsOthersOrOtherObjectsEndsNothing) {
  goes_on_after({"706#00", "000#8106", "000#0105", "606#23001A0110007760", "605#40001A0100000000",
                 "605#2B40600006000000", "585#60001A0100000000", "705#05"});
}

TEST_F(TpdoValuesTest, WhatWasBroughtBeforeTheEndIsNotTakenAfterIt) {
  const auto since = session->now();
  bus->arrive("185#3702", 1ms);
  bus->arrive("705#00", 2ms);
  pass(5ms);
  EXPECT_FALSE(values->take(kTorque, since));
}

TEST_F(TpdoValuesTest, AMappingThatChangesWhileItIsReadIsNotLearned) {
  const auto before = session->can()->epoch(5);
  bus->arrive("605#23001A0110007760", 1ms);
  pass(2ms);
  session->can()->learn_pdos(5, {}, before);
  EXPECT_EQ(session->can()->known_pdos(5), nullptr);
}

TEST_F(TpdoValuesTest, ANodeIsAskedAgainOnceItIsLeftAloneAndThenNowAndThen) {
  EXPECT_FALSE(lifetime->is_to_renew());
  bus->arrive("705#00", 1ms);
  pass(5ms);
  EXPECT_FALSE(lifetime->is_to_renew());
  pass(500ms);
  bus->arrive("605#23001A0110007760", 1ms);
  pass(5ms);
  EXPECT_FALSE(lifetime->is_to_renew());
  pass(Lifetime::kSettling - 10ms);
  EXPECT_FALSE(lifetime->is_to_renew());
  pass(20ms);
  EXPECT_TRUE(lifetime->is_to_renew());
  EXPECT_FALSE(lifetime->is_to_renew());
  pass(Lifetime::kAgain + 1ms);
  EXPECT_TRUE(lifetime->is_to_renew());
}

TEST_F(TpdoValuesTest, AnNmtCommandOfAnotherMasterMakesTheStateUnknown) {
  bus->arrive("705#00", 1ms);
  pass(5ms);
  EXPECT_EQ(session->watch().state(5), NodeState::pre_operational);
  bus->arrive("000#0105", 1ms);
  pass(5ms);
  EXPECT_FALSE(session->watch().state(5));
}

}  // namespace
}  // namespace servoctl::session
