// Commands on a ring of simulated EtherCAT slaves: what they say of it.
#include "ring_support.hpp"

namespace servoctl::cli {
namespace {

TEST_F(RingTest, AScanLeavesItAsItIs) {
  open("sv2@1,sv2@2");
  const auto said = run("scan");
  EXPECT_NE(said.find(R"("node":2,"station":0,"alias":0,"vendor_id":4478547)"), std::string::npos) << said;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(slave(i).state(), EscState::init);
    EXPECT_EQ(station(i), 0U);
  }
  EXPECT_EQ(context.notices, std::vector<Message>{});
}

TEST_F(RingTest, AllNodesAreThePlacesOnIt) {
  open("sv2@1,sv2@2,sv2@3");
  EXPECT_EQ(session::nodes_present(*session_).value(), (std::vector<std::uint8_t>{1, 2, 3}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(slave(i).state(), EscState::init);
}

TEST_F(RingTest, ObjectsAreReadInPreOpOnly) {
  open("sv2@1,sv2@2");
  ASSERT_TRUE(session_->upload(2, objects::kDeviceType));
  const auto said = run("scan");
  EXPECT_NE(said.find(R"("node":2,"station":4098)"), std::string::npos) << said;
  EXPECT_NE(said.find(R"("device_type":262546,"device_name":"DSX00E")"), std::string::npos) << said;
  EXPECT_EQ(slave(0).state(), EscState::init);
}

TEST_F(RingTest, ObjectsAreLeftAloneWhereAnotherMasterGaveTheAddresses) {
  open("sv2@1");
  ASSERT_TRUE(session_->upload(1, objects::kDeviceType));
  const Bytes address{0x34, 0x12};
  ASSERT_TRUE(slave().registers().write(ethercat::reg::kStationAddress, address));
  session_ = connect();
  const auto said = run("scan");
  EXPECT_NE(said.find(R"("device_type":null)"), std::string::npos) << said;
  EXPECT_EQ(station(), 0x1234U);
}

TEST_F(RingTest, ARingOfAnotherMasterIsLookedAtAndToldSo) {
  open("sv2@1,sv2@2");
  network().learn(2, rules());
  ASSERT_TRUE(network().request_state(2, NodeState::operational));
  const auto other = connect();
  const auto said = run_on(*other, "scan", {});
  EXPECT_TRUE(notes("another master works with this ring: node 2 is in OP. It was only looked at"))
      << notices();
  EXPECT_NE(said.find(R"("vendor_id":null)"), std::string::npos) << said;
  EXPECT_EQ(slave(1).state(), EscState::op);
  const auto info = run_on(*other, "info", {1});
  ASSERT_EQ(context.errors.size(), 1U) << info;
  EXPECT_EQ(context.errors.front().message.text(),
            "node 1: another master works with this ring: node 2 is in OP");
}

TEST_F(RingTest, WhatServoctlItselfHoldsInOpIsNoOtherMasters) {
  open("sv2@1");
  network().learn(1, rules());
  ASSERT_TRUE(network().request_state(1, NodeState::operational));
  const auto said = run("scan");
  EXPECT_FALSE(notes("another master")) << notices();
  EXPECT_NE(said.find(R"("vendor_id":4478547)"), std::string::npos) << said;
  EXPECT_EQ(slave().state(), EscState::op);
}

TEST_F(RingTest, AnEmptySiiIsToldAndTheRestIsShown) {
  open_with(sim::SiiFault::blank);
  const auto said = run("scan");
  EXPECT_TRUE(notes("node 1: SII: it is empty")) << notices();
  EXPECT_NE(said.find(R"("vendor_id":null)"), std::string::npos) << said;
  EXPECT_NE(said.find(R"("coe":null)"), std::string::npos) << said;
}

TEST_F(RingTest, AWrongChecksumIsTold) {
  open_with(sim::SiiFault::checksum);
  const auto said = run("scan");
  EXPECT_TRUE(notes("node 1: SII: the checksum of its first words is")) << notices();
  EXPECT_NE(said.find(R"("sii_doubts":["the checksum)"), std::string::npos) << said;
}

TEST_F(RingTest, AnAliasIsShown) {
  open_with(sim::SiiFault::none, 0x0102);
  EXPECT_NE(run("scan").find(R"("alias":258)"), std::string::npos);
}

TEST_F(RingTest, ErrorCountersOfPortsAreToldInWords) {
  open("sv2@1");
  for (int i = 0; i < 3; ++i) slave().registers().count_damage(0);
  const auto said = run("scan");
  EXPECT_TRUE(notes("node 1: port 0: 3 bad frames")) << notices();
  EXPECT_NE(said.find(R"("bad_frames":3)"), std::string::npos) << said;
}

}  // namespace
}  // namespace servoctl::cli
