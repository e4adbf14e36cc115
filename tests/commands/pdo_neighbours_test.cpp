// What a change of PDOs and a SYNC producer have to mind beside the node itself: who else is on the bus.
#include <gtest/gtest.h>

#include <fstream>

#include "canopen/sync.hpp"
#include "drive/standard_objects.hpp"
#include "session/can_network.hpp"
#include "tested_drive.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

class Neighbours : public TestedDrive {
 protected:
  void SetUp() override { build("ts@1,ts@2", "ts"); }

  Result<report::Value> map(const std::string& pdo, const std::string& object, const std::string& can_id) {
    return run("pdo map", {{"pdo", pdo}, {"object", object}, {"--cob-id", can_id}});
  }
  /// The change is refused for this reason, and nothing was written.
  void expect_refused(const std::string& pdo, const std::string& object, const std::string& can_id,
                      std::string_view reason) {
    const auto before = drive().value({0x1800, 1});
    const auto result = map(pdo, object, can_id);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::refused);
    EXPECT_NE(result.error().message.text().find(reason), std::string::npos) << result.error().message.text();
    EXPECT_EQ(drive().value({0x1800, 1}), before);
    EXPECT_TRUE(questions.empty());
  }
};

TEST_F(Neighbours, TwoTpdosDoNotGetOneCanId) {
  expect_refused("TPDO1", "statusword", "0x182", "TPDO1 of node 2: both would send");
}

TEST_F(Neighbours, ATpdoDoesNotCommandAnotherDrive) {
  expect_refused("TPDO1", "statusword", "0x202", "RPDO1 of node 2: what one sends would control the other");
}

TEST_F(Neighbours, TwoDrivesAreNotCommandedByOneFrame) {
  expect_refused("RPDO1", "controlword", "0x202", "RPDO1 of node 2: one frame would control both");
}

TEST_F(Neighbours, ALinkFromTheTpdoOfAnotherIsTold) {
  const auto result = map("RPDO2", "target_velocity", "0x182");
  ASSERT_TRUE(result) << result.error().message.text();
  ASSERT_FALSE(context.notices.empty());
  EXPECT_NE(context.notices.front().text().find("RPDO2 receives what TPDO1 of node 2 sends with 0x182"),
            std::string::npos)
      << context.notices.front().text();
}

TEST_F(Neighbours, WhereNobodyIsNothingIsInTheWay) {
  EXPECT_TRUE(map("TPDO1", "statusword", "0x187"));
  EXPECT_TRUE(context.errors.empty());
}

TEST_F(Neighbours, SeveralNodesAreNotGivenOneCanIdByAFile) {
  context.nodes = {1, 2};
  const std::filesystem::path file = own_file("shared.toml");
  std::ofstream(file) << "format = 1\n[[pdo]]\npdo = \"RPDO1\"\ncob_id = \"0x205\"\nvalid = true\n";
  const auto result = run("pdo apply", {{"file", file.string()}});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::refused) << result.error().message.text();
  EXPECT_NE(result.error().message.text().find("one frame would control both"), std::string::npos)
      << result.error().message.text();
}

class SyncBesideOthers : public TestedDrive {
 protected:
  /// A heartbeat of node 1 stands for a SYNC, from a time on.
  void SetUp() override {
    build("gsd600@1", "gsd600");
    ASSERT_TRUE(session->download(1, objects::kProducerHeartbeat, {50, 0}));
    bus->on_receive = [this](can::Frame& frame) {
      if (frame.id == 0x701 && sim_bus.now() >= from) frame = canopen::sync_frame();
    };
  }
  TimePoint from{};
};

TEST_F(SyncBesideOthers, IsNotProduced) {
  const auto result = run("sync start", {{"--for", "1s"}});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::refused);
  EXPECT_EQ(session->can()->sync(), nullptr);
}

TEST_F(SyncBesideOthers, IsToldWhereTheOtherComesLater) {
  from = sim_bus.now() + std::chrono::milliseconds(600);
  const auto result = run("sync start", {{"--for", "1s"}});
  ASSERT_TRUE(result) << result.error().message.text();
  ASSERT_EQ(context.notices.size(), 1U);
  EXPECT_NE(context.notices.front().text().find("another producer sent"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::commands
