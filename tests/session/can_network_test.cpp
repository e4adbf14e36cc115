// The seam seen from the CAN side: NMT, SDO and frames behind states, channels and events.
#include "session/can_network.hpp"

#include <gtest/gtest.h>

#include "scripted_bus.hpp"
#include "session/foreign_writes.hpp"
#include "session/hearing.hpp"
#include "session/session.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

class CanNetworkTest : public testing::Test {
 protected:
  CanNetworkTest() {
    auto owned = std::make_unique<ScriptedBus>();
    bus = owned.get();
    session.emplace(std::move(owned), "can9", Options{});
  }
  void pass(Duration time) {
    ASSERT_TRUE(session->wait([] { return false; }, session->now() + time));
  }

  ScriptedBus* bus = nullptr;
  std::optional<Session> session;
};

TEST_F(CanNetworkTest, AsksForStatesByNmtAndRefusesThoseItHasNoWordFor) {
  auto& network = session->network();
  EXPECT_TRUE(network.request_state(5, NodeState::operational));
  EXPECT_TRUE(network.request_state(5, NodeState::stopped));
  EXPECT_TRUE(network.request_state(5, NodeState::pre_operational));
  EXPECT_EQ(bus->sent, (std::vector<std::string>{"000#0105", "000#0205", "000#8005"}));
  for (const auto state :
       {NodeState::unknown, NodeState::initialising, NodeState::bootstrap, NodeState::safe_operational})
    EXPECT_EQ(network.request_state(5, state).error().code, Errc::usage) << name(state);
  EXPECT_EQ(bus->sent.size(), 3U);
}

TEST_F(CanNetworkTest, HasHeartbeatAndGuardingForItsNodesAndNoProcessImage) {
  EXPECT_TRUE(session->network().carries(LifeSign::Kind::heartbeat));
  EXPECT_TRUE(session->network().carries(LifeSign::Kind::guarding));
  EXPECT_FALSE(session->network().carries(LifeSign::Kind::process_data));
}

TEST_F(CanNetworkTest, HasNoGuardingWhereThereAreNoRemoteFrames) {
  CanNetwork remote(std::make_unique<ScriptedBus>(), "socketcand://cabinet/can0");
  EXPECT_TRUE(remote.carries(LifeSign::Kind::heartbeat));
  EXPECT_FALSE(remote.carries(LifeSign::Kind::guarding))
      << "a motion would rely on questions that nobody hears";
}

TEST_F(CanNetworkTest, ABusOffNamesACommandOnlyWhereItHelps) {
  const auto hint_on = [](const std::string& url) {
    auto owned = std::make_unique<ScriptedBus>();
    auto* const wire = owned.get();
    CanNetwork network(std::move(owned), url);
    wire->arrive("20000040#0000000000000000", 1ms);
    const auto stepped = network.step(network.now() + 10ms);
    return stepped ? std::string("none") : stepped.error().hint.text();
  };
  EXPECT_NE(hint_on("socketcan:can9").find("`bus up can9`"), std::string::npos);
  EXPECT_EQ(hint_on("slcan:/dev/ttyACM0@500k").find("bus up"), std::string::npos);
  EXPECT_NE(hint_on("slcan:/dev/ttyACM0@500k").find("opens the adapter anew"), std::string::npos);
}

TEST_F(CanNetworkTest, TellsStatesAndEventsInTheWordsOfEveryNetworkInTheOrderOfTime) {
  bus->arrive("705#00", 1ms);
  bus->arrive("085#1043080000000000", 2ms);
  bus->arrive("706#04", 3ms);
  bus->arrive("705#05", 4ms);
  bus->arrive("706#33", 5ms);
  pass(10ms);
  EXPECT_EQ(session->watch().state(5), NodeState::operational);
  EXPECT_EQ(session->watch().state(6), NodeState::unknown);
  EXPECT_EQ(session->watch().state(7), std::nullopt);
  EXPECT_EQ(session->watch().boots(5), 1U);
  EXPECT_EQ(session->watch().heartbeats(6), 2U);
  EXPECT_EQ(session->watch().emergencies(5).size(), 1U);
  const auto events = session->take_events();
  ASSERT_EQ(events.size(), 4U);
  EXPECT_TRUE(std::holds_alternative<NodeEvent::BootUp>(events[0].what));
  EXPECT_EQ(std::get<canopen::Emergency>(events[1].what).code, 0x4310);
  EXPECT_EQ(std::get<NodeEvent::StateChange>(events[2].what).state, NodeState::operational);
  EXPECT_EQ(events[3].node, 6);
  EXPECT_EQ(std::get<NodeEvent::StateChange>(events[3].what).state, NodeState::unknown);
}

TEST_F(CanNetworkTest, TellsANodeThatIsGoneByItsHeartbeatAndByGuarding) {
  for (int i = 1; i <= 3; ++i) bus->arrive("705#05", i * 100ms);
  session->can()->guard(6, {.period = 50ms, .life_factor = 2});
  pass(1s);
  std::vector<NodeEvent::Gone::Sign> signs;
  for (const auto& event : session->take_events())
    if (const auto* gone = std::get_if<NodeEvent::Gone>(&event.what)) signs.push_back(gone->sign);
  EXPECT_EQ(signs, (std::vector{NodeEvent::Gone::Sign::guarding, NodeEvent::Gone::Sign::heartbeat}));
}

TEST_F(CanNetworkTest, LetsEveryListenerHearEveryFrameUntilItEnds) {
  int outer = 0;
  int inner = 0;
  const Hearing first(*session, [&](const can::Frame&, TimePoint) { ++outer; });
  {
    const Hearing second(*session, [&](const can::Frame&, TimePoint) { ++inner; });
    bus->arrive("705#05", 1ms);
    pass(2ms);
  }
  bus->arrive("705#05", 1ms);
  pass(2ms);
  EXPECT_EQ(outer, 2);
  EXPECT_EQ(inner, 1);
}

TEST_F(CanNetworkTest, GivesEachFrameToTheChannelsOfItsNodeAlone) {
  bus->on_send = [](ScriptedBus& wire, const std::string& sent) {
    if (sent.starts_with("605#40")) wire.arrive("586#4F61600003000000", 1ms);
    if (sent.starts_with("605#40")) wire.arrive("585#4F61600001000000", 2ms);
  };
  EXPECT_EQ(session->upload(5, {0x6061, 0}), Bytes{1});
}

TEST_F(CanNetworkTest, UsesAChannelAgainWithTheTimeoutOfToday) {
  session->options().retries = 0;
  auto before = session->now();
  EXPECT_EQ(session->upload(5, {0x6061, 0}).error().code, Errc::timeout);
  EXPECT_EQ(session->now() - before, 500ms);
  session->options().timeout = 20ms;
  before = session->now();
  EXPECT_EQ(session->upload(5, {0x6061, 0}).error().code, Errc::timeout);
  EXPECT_EQ(session->now() - before, 20ms);
}

TEST_F(CanNetworkTest, LearnsWhereEmergenciesComeFromWhatIsReadAndWritten) {
  bus->on_send = [](ScriptedBus& wire, const std::string& sent) {
    if (sent.starts_with("605#4014")) wire.arrive("585#43141000C1010000", 1ms);
    if (sent.starts_with("606#2314")) wire.arrive("586#6014100000000000", 1ms);
  };
  ASSERT_TRUE(session->upload(5, {0x1014, 0}));
  ASSERT_TRUE(session->download(6, {0x1014, 0}, Bytes{0xC2, 0x01, 0, 0}));
  bus->arrive("1C1#1043080000000000", 1ms);
  bus->arrive("1C2#1043080000000000", 2ms);
  pass(5ms);
  EXPECT_EQ(session->watch().emergencies(5).size(), 1U);
  EXPECT_EQ(session->watch().emergencies(6).size(), 1U);
}

TEST_F(CanNetworkTest, TellsANodeOnceAPeriodThatServoctlLivesUntilItIsDisarmed) {
  auto& network = session->network();
  ASSERT_TRUE(network.arm_watchdog(5, {LifeSign::Kind::heartbeat, 126, 100ms}));
  pass(250ms);
  EXPECT_EQ(bus->sent, (std::vector<std::string>{"77E#05", "77E#05", "77E#05"}));
  network.disarm_watchdog(5);
  ASSERT_TRUE(network.arm_watchdog(5, {LifeSign::Kind::guarding, 0, 100ms, 5}));
  bus->sent.clear();
  pass(250ms);
  EXPECT_EQ(bus->sent, (std::vector<std::string>{"705#R1", "705#R1", "705#R1"}));
  network.disarm_watchdog(5);
  bus->sent.clear();
  pass(250ms);
  EXPECT_TRUE(bus->sent.empty());
}

TEST_F(CanNetworkTest, SendsALastWordWithoutAnAnswer) {
  session->network().send_last_word(5, {0x6040, 0}, 0x0102);
  EXPECT_EQ(bus->sent, (std::vector<std::string>{"605#2B40600002010000"}));
}

TEST_F(CanNetworkTest, HearsWhatAnotherMasterBeginsToWriteOnOneNode) {
  std::vector<ObjectAddress> written;
  const ForeignWrites writes(*session, 5,
                             [&](ObjectAddress object, ForeignWrites::Way) { written.push_back(object); });
  for (const auto* frame : {"605#2B40600006000000", "605#4041600000000000", "606#2B40600006000000",
                            "605#C2FF600100100000", "605#C1FF600100100000", "605#2B4060000600"})
    bus->arrive(frame, 1ms);
  pass(5ms);
  EXPECT_EQ(written, (std::vector<ObjectAddress>{{0x6040, 0}, {0x60FF, 1}}));
}

}  // namespace
}  // namespace servoctl::session
