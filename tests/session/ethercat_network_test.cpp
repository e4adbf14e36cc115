// A session on a ring of simulated slaves.
#include "session/ethercat_network.hpp"

#include <gtest/gtest.h>

#include "drive/standard_objects.hpp"
#include "ethercat_world.hpp"

namespace servoctl::session {
namespace {

using std::chrono::milliseconds;

TEST_F(EtherCatTest, OpeningSendsNothing) {
  open("sv2@1");
  pass(milliseconds(300));
  EXPECT_EQ(ring().sent(), 0U);
}

TEST_F(EtherCatTest, ObjectsOfASlaveInInitAreRead) {
  open("sv2@1,sv2@2");
  EXPECT_EQ(load_le(session_->upload(2, objects::kVendorId).value()), 0x0044'5653U);
  EXPECT_EQ(slave(0).state(), sim::EscState::init) << "nobody asked for it";
  EXPECT_EQ(slave(1).state(), sim::EscState::pre_op);
  EXPECT_EQ(session_->watch().state(2), NodeState::pre_operational);
}

TEST_F(EtherCatTest, AReadOfASlaveInPreOpTakesTenFramesAtMost) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kVendorId));
  const auto before = ring().sent();
  session_ = connect();
  ASSERT_TRUE(session_->upload(1, objects::kVendorId));
  EXPECT_LE(ring().sent() - before, 10U);
}

TEST_F(EtherCatTest, AChannelSaysThatSomethingCameWhenItsAnswerIsThereAndNotBefore) {
  open("sv2@1,sv2@2?delay=20ms");
  ASSERT_TRUE(session_->upload(1, objects::kVendorId));
  const auto channel = network().object_channel(1, milliseconds(500));
  for (int round = 0; round < 3; ++round) {
    channel->start_upload(objects::kVendorId, session_->now(), canopen::Transfer::automatic, 0);
    EXPECT_TRUE(channel->stirred()) << "it is to be sent";
    ASSERT_TRUE(channel->on_time(session_->now()));
    int quiet = 0;
    for (; !channel->stirred() && quiet < 1000; ++quiet) ASSERT_TRUE(network().step(channel->deadline()));
    EXPECT_GT(quiet, 3) << "frames that looked in vain were none of its business";
    EXPECT_LT(quiet, 1000);
    ASSERT_TRUE(channel->on_time(session_->now()));
    const auto result = channel->take_result();
    ASSERT_TRUE(result);
    EXPECT_EQ(load_le(result->value()), 0x0044'5653U);
  }
  channel->start_upload(objects::kVendorId, session_->now(), canopen::Transfer::automatic, 0);
  ASSERT_TRUE(channel->on_time(session_->now()));
  ring().cut_cable(0);
  while (!channel->stirred() && session_->now() < channel->deadline())
    ASSERT_TRUE(network().step(channel->deadline()));
  EXPECT_TRUE(channel->stirred()) << "silence is something to be told as well";
  EXPECT_TRUE(channel->take_result());
}

TEST_F(EtherCatTest, AGapMayStandInEitherPdoAndADataTypeForOneInRpdosAlone) {
  open("sv2@1");
  for (const auto mapping : {std::uint16_t{0x1600}, std::uint16_t{0x1A00}}) {
    ASSERT_TRUE(session_->download(1, {mapping, 0}, {0}));
    EXPECT_TRUE(session_->download(1, {mapping, 1}, store_le(0x0000'0008U, 4))) << mapping;
  }
  EXPECT_TRUE(session_->download(1, {0x1600, 1}, store_le(0x0005'0008U, 4)));
  EXPECT_EQ(session_->download(1, {0x1A00, 1}, store_le(0x0005'0008U, 4)).error().abort_code, 0x0604'0041U);
}

TEST_F(EtherCatTest, APlaceWithoutASlaveIsTold) {
  open("sv2@1,sv2@2");
  const auto answer = session_->upload(3, objects::kVendorId);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Errc::timeout);
  EXPECT_EQ(answer.error().message.text(),
            "node 3: there is no slave at this position (slaves on the ring: 2)");
}

TEST_F(EtherCatTest, WritesAndAbortsAreTheDrives) {
  open("sv2@1");
  EXPECT_TRUE(session_->download(1, objects::kTargetVelocity, store_le(1000U, 4)));
  EXPECT_EQ(slave().model().values().number(objects::kTargetVelocity), 1000U);
  EXPECT_EQ(session_->upload(1, {0x1234, 0}).error().abort_code, 0x0602'0000U);
}

TEST_F(EtherCatTest, ARingWithAnotherMasterIsNotTouched) {
  open("sv2@1,sv2@2");
  ASSERT_TRUE(session_->upload(1, objects::kVendorId));
  ASSERT_TRUE(session_->upload(2, objects::kVendorId));
  network().learn(2, rules());
  ASSERT_TRUE(network().request_state(2, NodeState::safe_operational));
  const auto other = connect();
  const auto answer = other->upload(1, objects::kVendorId);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Errc::refused);
  EXPECT_EQ(answer.error().message.text(),
            "node 1: another master works with this ring: node 2 is in SAFE-OP");
  EXPECT_EQ(other->network().ethercat()->look(true).value().size(), 2U);
  other->network().ethercat()->take_over(2);
  EXPECT_TRUE(other->network().request_state(2, NodeState::pre_operational));
  EXPECT_EQ(slave(1).state(), sim::EscState::pre_op);
  pass(milliseconds(300));  // The first notices that it was taken from it.
  ASSERT_TRUE(network().request_state(2, NodeState::safe_operational));
  EXPECT_EQ(connect()->upload(1, objects::kVendorId).error().code, Errc::refused);
  EXPECT_TRUE(other->network().ethercat()->look(false).value()[1].foreign) << "taken over once, not for ever";
}

TEST_F(EtherCatTest, ASlaveGoesToOpAndBack) {
  open("sv2@1");
  network().learn(1, rules());
  const auto up = network().request_state(1, NodeState::operational);
  ASSERT_TRUE(up) << up.error().message.text();
  EXPECT_EQ(slave().state(), sim::EscState::op);
  EXPECT_TRUE(network().must_go_on());
  pass(milliseconds(500));
  EXPECT_EQ(slave().state(), sim::EscState::op) << "cycles go on";
  ASSERT_TRUE(network().request_state(1, NodeState::pre_operational));
  EXPECT_EQ(slave().state(), sim::EscState::pre_op);
  EXPECT_EQ(load_le(session_->upload(1, {0x1C12, 0}).value()), 0U) << "the assignment is as it was";
  EXPECT_FALSE(network().must_go_on());
}

TEST_F(EtherCatTest, ClosingTakesSlavesOutOfOpAndTellsEachOrder) {
  open("sv2@1,sv2@2");
  std::vector<std::string> told;
  Options options;
  options.ordered = [&](const Session& session, std::uint8_t node, std::string_view order) {
    told.push_back(session.url() + " " + std::to_string(node) + " " + std::string(order));
  };
  session_ = connect(std::move(options));
  for (const std::uint8_t node : std::initializer_list<std::uint8_t>{1, 2}) {
    network().learn(node, rules());
    ASSERT_TRUE(network().request_state(node, NodeState::operational));
    ASSERT_EQ(slave(node - 1U).state(), sim::EscState::op);
  }
  told.clear();
  EXPECT_TRUE(session_->close());
  for (const std::uint8_t node : std::initializer_list<std::uint8_t>{1, 2}) {
    EXPECT_EQ(slave(node - 1U).state(), sim::EscState::pre_op);
    EXPECT_EQ(
        std::count(told.begin(), told.end(), "coe:sim " + std::to_string(node) + " the request for PRE-OP"),
        1);
  }
}

/// Whoever is told may be gone before the session is.
TEST_F(EtherCatTest, ASessionThatIsDestroyedSendsNothingAndTellsNobody) {
  open("sv2@1");
  int told = 0;
  Options options;
  options.ordered = [&](const Session&, std::uint8_t, std::string_view) { ++told; };
  session_ = connect(std::move(options));
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  const auto before = told;
  const auto sent = ring().sent();
  session_.reset();
  EXPECT_EQ(told, before);
  EXPECT_EQ(ring().sent(), sent);
}

TEST_F(EtherCatTest, ASlaveThatDoesNotGoBackIsAnErrorOfClosing) {
  open("sv2@1,sv2@2");
  for (const std::uint8_t node : std::initializer_list<std::uint8_t>{1, 2}) {
    network().learn(node, rules());
    ASSERT_TRUE(network().request_state(node, NodeState::operational));
  }
  ring().cut_cable(1);
  const auto closed = session_->close();
  ASSERT_FALSE(closed);
  EXPECT_EQ(slave(0).state(), sim::EscState::pre_op) << "the other one is put back all the same";
}

/// A second signal ends a program that nothing protects, and would leave the slave in OP.
TEST_F(EtherCatTest, SignalsAreHeldBackUntilASlaveIsOutOfOp) {
  std::vector<std::pair<Care, sim::EscState>> told;
  Protection protection([&](Care worst) { told.emplace_back(worst, slave().state()); });
  session_options_.protection = &protection;
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  pass(milliseconds(100));
  EXPECT_EQ(protection.worst(), Care::unsettled);
  EXPECT_TRUE(session_->close());
  session_.reset();
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back().first, Care::none);
  for (const auto& [care, state] : told)
    EXPECT_EQ(state, sim::EscState::pre_op) << "it changes outside OP alone";
}

TEST_F(EtherCatTest, ADriveWithAClockOf32BitsIsRunWithSync0) {
  open("sv2@1?free-run=no&clock=32");
  network().learn(1, rules());
  // The first pulse lies behind the wrap of its clock.
  ASSERT_TRUE(session_->upload(1, objects::kVendorId));
  ASSERT_TRUE(slave().registers().write(0x0920, store_le(0xFFFF'FFFFU, 8)));
  const auto up = network().request_state(1, NodeState::operational);
  ASSERT_TRUE(up) << up.error().message.text();
  pass(std::chrono::seconds(10));
  EXPECT_EQ(slave().state(), sim::EscState::op);
}

TEST_F(EtherCatTest, AWrongWorkingCounterIsNamed) {
  open("sv2@1");
  int told = 0;
  Options options;
  options.ordered = [&](const Session&, std::uint8_t, std::string_view) { ++told; };
  session_ = connect(std::move(options));
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  slave().faults().withholds_inputs = true;
  (void)session_->wait([] { return false; }, session_->now() + milliseconds(10));
  const auto begun = session_->now();
  const auto read = session_->upload(1, objects::kStatusword);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.text().find("working counter 2 instead of 3"), std::string::npos)
      << read.error().message.text();
  EXPECT_LT(session_->now() - begun, milliseconds(100)) << "nothing more is to be expected";
  EXPECT_FALSE(session_->download(1, objects::kTargetVelocity, store_le(0U, 4)));
}

TEST_F(EtherCatTest, OutputsArePresetFromTheDriveBeforeOp) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(session_->download(1, {0x6060, 0}, {3}));
  const auto limit = session_->upload(1, {0x607F, 0}).value();
  const auto here = session_->upload(1, objects::kPositionActual).value();
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  pass(milliseconds(20));
  EXPECT_EQ(slave().model().values().number({0x6060, 0}), 3U);
  EXPECT_EQ(slave().model().values().number({0x607F, 0}), load_le(limit));
  EXPECT_EQ(slave().model().values().number(objects::kTargetPosition), load_le(here));
  EXPECT_EQ(slave().model().values().number(objects::kTargetVelocity), 0U);
}

TEST_F(EtherCatTest, MappedObjectsGoThroughTheImage) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  slave().faults().mailbox_stays_full = true;
  EXPECT_TRUE(session_->download(1, objects::kTargetVelocity, store_le(500U, 4)));
  EXPECT_EQ(slave().model().values().number(objects::kTargetVelocity), 500U);
  EXPECT_TRUE(session_->upload(1, objects::kStatusword));
  EXPECT_FALSE(session_->upload(1, objects::kVendorId)) << "by the mailbox, which is full";
}

TEST_F(EtherCatTest, AWriteWhoseOutputsAreNotTakenIsNoSuccess) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  ring().cut_cable(0);
  const auto done = session_->download(1, objects::kTargetVelocity, store_le(500U, 4));
  ASSERT_FALSE(done);
  EXPECT_EQ(slave().model().values().number(objects::kTargetVelocity), 0U);
}

TEST_F(EtherCatTest, ASlaveInBootIsToldAndInitTakesItOutOfIt) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  slave().plan_fall({session_->now(), sim::EscState::boot, 0x0013});
  pass(milliseconds(400));
  ASSERT_EQ(slave().state(), sim::EscState::boot);
  const auto refused = session_->upload(1, objects::kVendorId);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::negative);
  EXPECT_EQ(refused.error().message.text(), "node 1: it is in BOOT and takes firmware only");
  EXPECT_EQ(refused.error().hint.text(), "`state init -n 1`");
  const auto out = network().request_state(1, NodeState::initialising);
  ASSERT_TRUE(out) << out.error().message.text();
  EXPECT_EQ(slave().state(), sim::EscState::init);
  EXPECT_TRUE(session_->upload(1, objects::kVendorId));
}

TEST_F(EtherCatTest, ASlaveThatRestartsIsTold) {
  open("sv2@1,sv2@2");
  ASSERT_TRUE(session_->upload(1, objects::kVendorId));
  ring().power_off(0);
  ring().power_on(0, port_->now());
  pass(milliseconds(400));
  const auto events = session_->take_events();
  ASSERT_FALSE(events.empty());
  EXPECT_TRUE(std::holds_alternative<NodeEvent::BootUp>(events.front().what));
  EXPECT_EQ(session_->watch().boots(1), 1U);
  EXPECT_TRUE(session_->upload(1, objects::kVendorId)) << "it is brought up again";
}

TEST_F(EtherCatTest, ASlaveBehindACutCableIsGoneAndBack) {
  open("sv2@1,sv2@2");
  ASSERT_TRUE(session_->upload(2, objects::kVendorId));
  ring().cut_cable(1);
  pass(milliseconds(400));
  auto events = session_->take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<NodeEvent::Gone>(events.front().what));
  EXPECT_FALSE(session_->upload(2, objects::kVendorId));
  ring().join_cable(1);
  pass(milliseconds(400));
  events = session_->take_events();
  ASSERT_FALSE(events.empty());
  EXPECT_TRUE(std::holds_alternative<NodeEvent::Back>(events.front().what));
  EXPECT_TRUE(session_->upload(2, objects::kVendorId));
}

TEST_F(EtherCatTest, ASlaveThatFallsOutOfOpIsToldWithItsReason) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  slave().plan_fall({port_->now() + milliseconds(50), sim::EscState::safe_op, 0x001A});
  pass(milliseconds(400));
  bool told = false;
  for (const auto& event : session_->take_events())
    if (const auto* error = std::get_if<NodeEvent::StateError>(&event.what))
      told = told || error->code == 0x1A;
  EXPECT_TRUE(told);
  EXPECT_FALSE(network().must_go_on());
  EXPECT_TRUE(session_->upload(1, objects::kVendorId));
  EXPECT_TRUE(network().request_state(1, NodeState::pre_operational));
}

TEST_F(EtherCatTest, ADriveThatRefusesFreeRunIsRunWithSync0) {
  open("sv2@1");
  network().learn(1, rules());
  slave().faults().refuses_free_run = true;
  const auto up = network().request_state(1, NodeState::operational);
  ASSERT_TRUE(up) << up.error().message.text();
  EXPECT_EQ(slave().state(), sim::EscState::op);
  const auto notices = network().take_notices();
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices.front().text().find("SYNC0"), std::string::npos) << notices.front().text();
  EXPECT_NE(notices.front().text().find("0027h"), std::string::npos) << notices.front().text();
  pass(milliseconds(500));
  EXPECT_EQ(slave().state(), sim::EscState::op);
  ASSERT_TRUE(network().request_state(1, NodeState::pre_operational));
  EXPECT_FALSE(slave().registers().is_sync0_set_up());
  EXPECT_EQ(load_le(session_->upload(1, {0x1C12, 0}).value()), 0U);
}

TEST_F(EtherCatTest, ASlaveThatRefusesOpIsToldInWordsAndLeftInPreOp) {
  open("sv2@1");
  network().learn(1, rules());
  slave().faults().state_delay = std::chrono::seconds(30);
  ASSERT_FALSE(network().request_state(1, NodeState::operational));
  EXPECT_NE(slave().state(), sim::EscState::op);
  EXPECT_FALSE(network().must_go_on());
}

TEST_F(EtherCatTest, NoSlaveIsNoNetwork) {
  open("sv2@1");
  ring().cut_cable(0);
  const auto answer = session_->upload(1, objects::kVendorId);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Errc::bus);
}

TEST_F(EtherCatTest, ASlaveThatTakesAnothersPlaceIsNotTakenForIt) {
  open("sv2@1,sv2@2");
  ASSERT_TRUE(session_->upload(1, objects::kVendorId));
  ASSERT_TRUE(session_->upload(2, objects::kVendorId));
  // The first was taken out: in its place stands the one that was the second.
  ASSERT_TRUE(slave(0).registers().write(0x0010, store_le(0x1002U, 2)));
  ring().cut_cable(1);
  pass(milliseconds(400));
  const auto answer = session_->upload(1, objects::kVendorId);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().message.text(), "coe:sim: the ring has changed since its slaves were numbered");
  EXPECT_FALSE(network().look(false)) << "nobody has asked for new numbers";
  EXPECT_FALSE(session_->upload(1, objects::kVendorId));
  ASSERT_TRUE(network().look(true));
  EXPECT_TRUE(session_->upload(1, objects::kVendorId)) << "numbered anew";
}

TEST_F(EtherCatTest, TwoSlavesAreInOpAtTheSameTime) {
  open("sv2@1,sv2@2");
  network().learn(1, rules());
  network().learn(2, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  const auto second = network().request_state(2, NodeState::operational);
  ASSERT_TRUE(second) << second.error().message.text();
  pass(milliseconds(300));
  EXPECT_EQ(slave(0).state(), sim::EscState::op);
  EXPECT_EQ(slave(1).state(), sim::EscState::op);
  ASSERT_TRUE(session_->download(2, objects::kTargetVelocity, store_le(7U, 4)));
  EXPECT_EQ(slave(0).model().values().number(objects::kTargetVelocity), 0U);
  EXPECT_EQ(slave(1).model().values().number(objects::kTargetVelocity), 7U);
}

}  // namespace
}  // namespace servoctl::session
