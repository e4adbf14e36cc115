// `replay`: what it leaves behind, and what it says of what it sends.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "drive/naming.hpp"
#include "drive/standard_objects.hpp"
#include "motion/left_energised.hpp"
#include "tested_drive.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

constexpr std::string_view kEnable =
    "(0.000000) can0 000#0101\n"
    "(0.010000) can0 601#2B40600006000000\n"
    "(0.030000) can0 601#2B40600007000000\n"
    "(0.050000) can0 601#2B4060000F000000\n";

class Replay : public TestedDrive {
 protected:
  Result<report::Value> replay(std::string_view log, Words words = {}) {
    const auto path = own_file("replay_test.log");
    std::ofstream(path) << log;
    words.emplace_back("file", path);
    return run("replay", words);
  }
  bool is_noticed(std::string_view text) const {
    for (const auto& notice : context.notices)
      if (notice.text().find(text) != std::string::npos) return true;
    return false;
  }
  std::string question(std::string_view log) {
    questions.clear();
    context.session->options().cancelled = {};
    EXPECT_TRUE(replay(log));
    return questions.empty() ? "" : questions.front();
  }
};

class ReplayEveryFamily : public Replay, public testing::WithParamInterface<const char*> {};

TEST_P(ReplayEveryFamily, CtrlCStopsAndDisablesTheDrive) {
  build(std::string(GetParam()) + "@1", GetParam());
  std::vector<bool> told;
  session::Protection protection([&](session::Care worst) { told.push_back(worst != session::Care::none); });
  session->options().protection = &protection;
  const auto begin = sim_bus.now();
  bool was_enabled = false;
  session->options().cancelled = [&] {
    was_enabled = was_enabled || drive().power_state() == DriveState::operation_enabled;
    return sim_bus.now() > begin + 3s;
  };
  const auto result = replay(std::string(kEnable) + "(9.000000) can0 080#\n");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::interrupted);
  EXPECT_TRUE(was_enabled);
  EXPECT_FALSE(drive::is_energised(drive().power_state()));
  EXPECT_TRUE(is_noticed("stopped and disabled")) << "the user is told";
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(told.front()) << "a second Ctrl-C does not end the process";
  EXPECT_FALSE(told.back());
}

TEST_F(Replay, ADriveThatIsInFaultAfterCtrlCIsAnError) {
  build("gsd600@1", "gsd600");
  bool is_stopping = false;
  session->options().cancelled = [&] {
    is_stopping = is_stopping || drive().power_state() == DriveState::operation_enabled;
    return is_stopping;
  };
  bus->on_receive = [&](can::Frame& frame) {
    const bool takes_stop =
        is_stopping && frame.id == 0x581 && frame.data[0] == 0x60 && frame.data[1] == 0x40;
    if (takes_stop && drive().power_state() == DriveState::quick_stop_active)
      drive().raise_fault(0x8611, {}, sim_bus.now());
  };
  ASSERT_FALSE(replay(std::string(kEnable) + "(9.000000) can0 080#\n"));
  ASSERT_FALSE(context.errors.empty());
  EXPECT_NE(context.errors.front().message.text().find("de-energised now, but in fault"), std::string::npos)
      << context.errors.front().message.text();
  EXPECT_FALSE(is_noticed("stopped and disabled"));
}

TEST_P(ReplayEveryFamily, SaysThatADriveIsLeftEnergised) {
  build(std::string(GetParam()) + "@1", GetParam());
  ASSERT_TRUE(replay(kEnable));
  EXPECT_EQ(drive().power_state(), DriveState::operation_enabled);
  // As after every line, whichever command energised it.
  motion::tell_left_energised(context, session->energised().nodes());
  EXPECT_TRUE(is_noticed("node 1 IS ENERGISED"));
  EXPECT_TRUE(session->energised().contains(1)) << "a prompt that ends disables it";
}

INSTANTIATE_TEST_SUITE_P(Families, ReplayEveryFamily, testing::Values("gsd600", "dm", "sv2", "da200", "ts"));

TEST_F(Replay, ADriveThatFallsSilentMayStillBeEnergised) {
  build("gsd600@1", "gsd600");
  const auto begin = sim_bus.now();
  session->options().cancelled = [&, begin] {
    drive().wire_faults().silent = sim_bus.now() > begin + 500ms;
    return sim_bus.now() > begin + 1s;
  };
  ASSERT_FALSE(replay(std::string(kEnable) + "(9.000000) can0 080#\n"));
  ASSERT_FALSE(context.errors.empty());
  EXPECT_TRUE(context.errors.front().message.text().starts_with("NODE 1 MAY STILL BE ENERGISED"));
}

TEST_F(Replay, CountsWhateverCanMoveAMotor) {
  build("gsd600@1", "gsd600");
  EXPECT_NE(question("(0.0) can0 080#\n").find("1 SYNC"), std::string::npos);
  EXPECT_NE(question("(0.0) can0 601#23FF600000000000\n").find("1 write of"), std::string::npos);
  EXPECT_NE(question("(0.0) can0 601#2F60600001000000\n").find("1 write of"), std::string::npos);
  EXPECT_NE(question("(0.0) can0 201#0600\n").find("1 RPDO"), std::string::npos);
  EXPECT_EQ(question("(0.0) can0 601#4040600000000000\n").find("can move"), std::string::npos)
      << "reading moves nothing";
  EXPECT_EQ(question("(0.0) can0 601#2B17100000000000\n").find("can move"), std::string::npos);
}

TEST_F(Replay, OfTheNamedBusSendsAndAsksNothingOfTheOthers) {
  build("gsd600@1", "gsd600");
  constexpr std::string_view kBoth =
      "(0.000000) can0 601#2B171000E8030000\n"
      "(0.010000) can1 601#2B171000D0070000\n"
      "(0.020000) can1 609#4041600000000000\n";
  EXPECT_FALSE(replay(kBoth)) << "which of them is not said";
  EXPECT_FALSE(replay(kBoth, {{"--channel", "can7"}}));
  const auto begin = sim_bus.now();
  ASSERT_TRUE(replay(kBoth, {{"--channel", "can0"}}));
  EXPECT_LT(sim_bus.now() - begin, 300ms) << "node 9 of the other bus is waited for";
  EXPECT_EQ(load_le(drive().value(objects::kProducerHeartbeat)), 1000U);
}

TEST_F(Replay, WithoutAFamilyEveryVendorObjectCanMove) {
  build("gsd600@1", "gsd600");
  const auto* family = std::exchange(context.profile, nullptr);
  EXPECT_NE(question("(0.0) can0 601#2B00200000000000\n").find("can move"), std::string::npos);
  context.profile = family;
}

TEST_F(Replay, NamesWhatLastsAndWhatRestarts) {
  build("gsd600@1", "gsd600");
  EXPECT_NE(question("(0.0) can0 000#8101\n").find("1 NMT reset"), std::string::npos);
  EXPECT_NE(question("(0.0) can0 601#2310100173617665\n").find("1 store by"), std::string::npos);
  EXPECT_NE(question("(0.0) can0 7E5#1102000000000000\n").find("1 LSS command"), std::string::npos);
  const auto node_id = drive::resolve(context.profile, context.profile->rules.nmt.node_id);
  ASSERT_TRUE(node_id);
  const auto address = node_id->address;
  EXPECT_NE(question(fmt::format("(0.0) can0 601#2B{:02X}{:02X}{:02X}02000000\n", address.index & 0xFFU,
                                 address.index >> 8U, address.sub))
                .find("Some store, restart or re-address a drive: 1 write of"),
            std::string::npos);
}

TEST_F(Replay, AnSdoThatIsRefusedOrNotAnsweredFails) {
  build("gsd600@1", "gsd600");
  ASSERT_TRUE(replay("(0.0) can0 601#2BFF200001000000\n(0.1) can0 601#4041600000000000\n"));
  ASSERT_TRUE(failed());
  EXPECT_EQ(context.errors.front().object, (ObjectAddress{0x20FF, 0}));
  EXPECT_NE(context.errors.front().message.text().find("0x06020000"), std::string::npos);
  drive().wire_faults().silent = true;
  ASSERT_TRUE(replay("(0.0) can0 601#4041600000000000\n"));
  EXPECT_TRUE(failed());
  EXPECT_NE(context.errors.front().message.text().find("not answered"), std::string::npos);
}

TEST_F(Replay, AnswersOfTheRecordingAreNoAnswersOfADrive) {
  build("gsd600@1", "gsd600");
  drive().wire_faults().silent = true;
  ASSERT_TRUE(replay("(0.0) can0 601#4041600000000000\n(0.001) can0 581#4B41600033020000\n"));
  EXPECT_TRUE(context.errors.empty());
  EXPECT_TRUE(is_noticed("only by the recording, not by a drive: 1"));
}

}  // namespace
}  // namespace servoctl::commands
