// What the session does on a network that is no CAN bus: objects in memory, and no frame anywhere.
#include "session/network.hpp"

#include <gtest/gtest.h>

#include "drive/standard_objects.hpp"
#include "memory_network.hpp"
#include "memory_objects.hpp"
#include "session/family_check.hpp"
#include "session/hearing.hpp"
#include "session/identify.hpp"
#include "session/process_values.hpp"
#include "session/scan.hpp"
#include "session/state_pause.hpp"
#include "session/write.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

/// Node 1 of a network in memory, with a session on it.
class NetworkTest : public testing::Test {
 protected:
  NetworkTest() {
    auto owned = std::make_unique<MemoryNetwork>();
    network = owned.get();
    objects.values = {{objects::kDeviceType, {0x92, 0x01, 0x02, 0x00}},
                      {objects::kVendorId, {4, 0, 0, 0}},
                      {objects::kProductCode, {7, 0, 0, 0}},
                      {objects::kRevision, {1, 0, 0, 0}},
                      {objects::kSerialNumber, {0x39, 0x30, 0, 0}},
                      {objects::kDeviceName, {'d', 'r', 'i', 'v', 'e'}},
                      {objects::kStatusword, {0x50, 0x02}},
                      {objects::kControlword, {0x06, 0x00}},
                      {objects::kModeOfOperation, {1}},
                      {objects::kPositionActual, {1, 2, 3, 4}}};
    objects.read_only.insert(objects::kStatusword);
    node = &network->add(1, objects);
    session.emplace(std::move(owned), "memory", Options{});
  }

  MemoryObjects objects;
  MemoryNetwork* network = nullptr;
  MemoryNode* node = nullptr;
  std::optional<Session> session;
};

TEST_F(NetworkTest, HasNothingOfCan) {
  EXPECT_EQ(session->can(), nullptr);
  const Hearing hearing(*session, [](const can::Frame&, TimePoint) { FAIL() << "there are no frames"; });
  EXPECT_TRUE(session->upload(1, objects::kDeviceType));
  EXPECT_TRUE(refuse_duplicate(*session, 1));
  EXPECT_TRUE(settle_duplicates(*session, std::vector<std::uint8_t>{1}, kBriefly));
}

TEST_F(NetworkTest, FindsWhoIsThereAndWhatTheySay) {
  std::vector<std::uint8_t> nodes;
  for (int id = 1; id <= 127; ++id) nodes.push_back(static_cast<std::uint8_t>(id));
  network->tell(1, NodeEvent::BootUp{});
  const auto before = session->now();
  const auto found = scan(*session, nodes);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().device_type, 0x0002'0192U);
  EXPECT_EQ(found->front().serial, 12345U);
  EXPECT_EQ(found->front().device_name, "drive");
  EXPECT_EQ(found->front().hardware_version, "");
  EXPECT_EQ(found->front().state, NodeState::pre_operational);
  EXPECT_LT(session->now() - before, 530ms) << "those that are not there cost one timeout in all";
  const auto identity = read_identity(*session, 1);
  ASSERT_TRUE(identity) << identity.error().message.text();
  EXPECT_EQ(identity->product_code, 7U);
}

TEST_F(NetworkTest, ReadsAnIdentityAgainWhenTheNodeHasRestarted) {
  const std::uint8_t nodes[] = {1};
  ASSERT_TRUE(identify(*session, nodes, drive::Rules{}).front());
  objects.values[objects::kProductCode] = {8, 0, 0, 0};
  EXPECT_EQ(identify(*session, nodes, drive::Rules{}).front()->product_code, 7U);
  network->tell(1, NodeEvent::BootUp{});
  EXPECT_EQ(identify(*session, nodes, drive::Rules{}).front()->product_code, 8U);
}

TEST_F(NetworkTest, WritesReadsBackAndCompares) {
  const SdoRequest request{1, objects::kModeOfOperation, Bytes{3}};
  const auto written = write_all(*session, std::span(&request, 1), true);
  ASSERT_TRUE(written.front()) << written.front().error().message.text();
  EXPECT_EQ(written.front()->read_back, Bytes{3});
  EXPECT_EQ(objects.values[objects::kModeOfOperation], Bytes{3});
}

TEST_F(NetworkTest, TellsARefusalWithItsAbortCodeAndWritesNothingAfterIt) {
  const std::vector<SdoRequest> requests{{1, objects::kModeOfOperation, Bytes{3}},
                                         {1, objects::kStatusword, Bytes{0, 0}},
                                         {1, objects::kModeOfOperation, Bytes{6}}};
  const auto answers = session->transfer(requests);
  EXPECT_TRUE(answers[0]);
  ASSERT_FALSE(answers[1]);
  EXPECT_EQ(answers[1].error().code, Errc::sdo_abort);
  EXPECT_EQ(answers[1].error().abort_code, 0x0601'0002U);
  EXPECT_EQ(answers[1].error().object, objects::kStatusword);
  ASSERT_FALSE(answers[2]);
  EXPECT_NE(answers[2].error().message.text().find("skipped because"), std::string::npos);
  EXPECT_EQ(objects.writes.size(), 1U);
  EXPECT_EQ(session->upload(1, {0x5FFF, 0}).error().abort_code, 0x0602'0000U);
}

TEST_F(NetworkTest, WaitsOnceForANodeThatDoesNotAnswer) {
  node->silent = true;
  const std::vector<SdoRequest> requests(20, SdoRequest{1, objects::kStatusword, {}});
  const auto before = session->now();
  const auto answers = session->transfer(requests);
  for (const auto& answer : answers) EXPECT_EQ(answer.error().code, Errc::timeout);
  EXPECT_EQ(session->now() - before, 1000ms) << "and its one retry";
}

TEST_F(NetworkTest, ReadsAgainWhereAnAnswerWasLostAndNeverWritesTwice) {
  node->lost_answers = 1;
  EXPECT_EQ(session->upload(1, objects::kModeOfOperation), Bytes{1});
  node->lost_answers = 1;
  const SdoRequest request{1, objects::kModeOfOperation, Bytes{3}};
  const auto written = write_all(*session, std::span(&request, 1), false);
  ASSERT_TRUE(written.front()) << written.front().error().message.text();
  EXPECT_TRUE(written.front()->answer_lost);
  EXPECT_EQ(objects.writes.size(), 1U);
}

TEST_F(NetworkTest, TellsThatItIsLostAndWorksWhenItIsBack) {
  network->lost = true;
  EXPECT_EQ(session->upload(1, objects::kStatusword).error().code, Errc::bus);
  EXPECT_EQ(session->network().recover(session->now() + 1s).error().code, Errc::bus);
  network->lost = false;
  EXPECT_TRUE(session->network().recover(session->now() + 1s));
  EXPECT_TRUE(session->upload(1, objects::kStatusword));
}

TEST_F(NetworkTest, EndsEveryWaitWhenItIsCancelled) {
  session->options().cancelled = [] { return true; };
  EXPECT_EQ(session->upload(1, objects::kStatusword).error().code, Errc::interrupted);
  EXPECT_EQ(session->wait([] { return false; }, session->now() + 1h).error().code, Errc::interrupted);
}

TEST_F(NetworkTest, TellsWhatNodesToldWhileSomethingElseWasWaitedFor) {
  const auto planned = session->now() + 100ms;
  bool told = false;
  node->deadline = [&] { return told ? kNever : planned; };
  node->take_event = [&]() -> std::optional<NodeEvent::What> {
    if (told || session->now() < planned) return std::nullopt;
    told = true;
    return canopen::Emergency{.node = 1, .code = 0x7500, .error_register = 0x10};
  };
  EXPECT_FALSE(session->upload(9, objects::kStatusword));
  const auto events = session->take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].time, planned);
  EXPECT_EQ(std::get<canopen::Emergency>(events[0].what).code, 0x7500);
  EXPECT_EQ(session->watch().emergencies(1).size(), 1U);
  network->tell(1, NodeEvent::Gone{100ms});
  network->tell(1, NodeEvent::BootUp{});
  EXPECT_EQ(session->take_events().size(), 2U);
  EXPECT_EQ(session->watch().boots(1), 1U);
}

TEST_F(NetworkTest, TakesANodeOutOfOperationalAndPutsItBack) {
  objects.values[objects::kProducerHeartbeat] = {100, 0};
  node->state = NodeState::operational;
  node->deadline = [&] { return session->now() + 100ms; };
  node->take_event = [&]() -> std::optional<NodeEvent::What> {
    return session->now() - TimePoint{} > 1100ms && session->watch().heartbeats(1) == 0
               ? std::optional<NodeEvent::What>(NodeEvent::StateChange{node->state})
               : std::nullopt;
  };
  StatePause pause(*session, 1);
  ASSERT_TRUE(pause.enter());
  EXPECT_EQ(node->state, NodeState::pre_operational);
  EXPECT_EQ(session->watch().state(1), NodeState::pre_operational);
  ASSERT_TRUE(pause.leave(true));
  EXPECT_EQ(node->state, NodeState::operational);
  EXPECT_TRUE(pause.notices().empty());
}

TEST_F(NetworkTest, AsksForAStateThatIsNotToldByItself) {
  node->state = NodeState::safe_operational;
  const auto state = ask_state(*session, 1);
  ASSERT_TRUE(state) << state.error().message.text();
  EXPECT_EQ(*state, NodeState::safe_operational);
}

TEST_F(NetworkTest, TellsWhyANodeDoesNotEnterAState) {
  node->on_state = [](NodeState state) { return state != NodeState::operational; };
  ASSERT_TRUE(session->network().request_state(1, NodeState::operational));
  const auto events = session->take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(std::get<NodeEvent::StateError>(events[0].what).code, 0x001B);
  EXPECT_EQ(node->state, NodeState::pre_operational);
}

TEST_F(NetworkTest, BringsProcessValuesOfNodesThatExchangeThemEachOnce) {
  const ObjectAddress wanted[] = {objects::kPositionActual};
  const auto values = process_values(*session, nullptr, 1, wanted);
  const auto since = session->now();
  EXPECT_EQ(values->take(objects::kPositionActual, since), std::nullopt) << "it is pre-operational";
  node->state = NodeState::safe_operational;
  ASSERT_TRUE(session->wait([] { return false; }, since + 4ms));
  EXPECT_EQ(values->take(objects::kPositionActual, since), (Bytes{1, 2, 3, 4}));
  EXPECT_EQ(values->take(objects::kPositionActual, since), std::nullopt);
  EXPECT_EQ(values->take(objects::kStatusword, since), std::nullopt) << "nobody wanted it";
  ASSERT_TRUE(session->wait([] { return false; }, since + 9ms));
  EXPECT_TRUE(values->take(objects::kPositionActual, since + 5ms));
}

TEST_F(NetworkTest, RefusesASignOfLifeThatItDoesNotCarryAndTakesALastWord) {
  ASSERT_FALSE(session->network().carries(LifeSign::Kind::heartbeat));
  const auto armed = session->network().arm_watchdog(1, {LifeSign::Kind::heartbeat, 127, 100ms});
  ASSERT_FALSE(armed);
  EXPECT_EQ(armed.error().code, Errc::usage);
  session->network().send_last_word(1, objects::kControlword, 0x0002);
  EXPECT_EQ(objects.values[objects::kControlword], (Bytes{2, 0}));
}

}  // namespace
}  // namespace servoctl::session
