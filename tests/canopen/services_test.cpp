// NMT, boot-up and heartbeat: the frames.
#include <gtest/gtest.h>

#include <vector>

#include "canopen/nmt.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

TEST(Nmt, CommandsAreTwoBytesOnIdZero) {
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::start, 5)), "000#0105");
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::stop, 127)), "000#027F");
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::enter_pre_operational, 0)), "000#8000");
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::reset_node, 1)), "000#8101");
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::reset_communication, 1)), "000#8201");
}

TEST(Nmt, FramesOfOtherShapeAreNoCommand) {
  EXPECT_TRUE(parse_nmt(frame("000#0105")));
  for (const auto* text : {"000#01", "000#010500", "001#0105", "000#0305", "00000000#0105", "000#R2"})
    EXPECT_FALSE(parse_nmt(frame(text))) << text;
}

TEST(Nmt, NamesGoBothWays) {
  for (const auto command : {NmtCommand::start, NmtCommand::stop, NmtCommand::enter_pre_operational,
                             NmtCommand::reset_node, NmtCommand::reset_communication})
    EXPECT_EQ(parse_nmt_command(name(command)), command);
  EXPECT_FALSE(parse_nmt_command("run"));
  EXPECT_FALSE(parse_nmt_command(""));
}

/// The frame with one of its flags set.
std::vector<can::Frame> flagged(std::string_view text) {
  std::vector<can::Frame> out(3, frame(text));
  out[0].extended = true;
  out[1].remote = true;
  out[2].error = true;
  return out;
}

TEST(Nmt, IsInPlainFramesOnly) {
  for (const auto& other : flagged("000#0105")) EXPECT_FALSE(parse_nmt(other));
  for (const auto& other : flagged("705#05")) EXPECT_FALSE(parse_error_control(other));
  EXPECT_FALSE(parse_nmt(frame("000#0005")));
}

TEST(Nmt, LeadsToAState) {
  EXPECT_EQ(state_after(NmtCommand::start), NmtState::operational);
  EXPECT_EQ(state_after(NmtCommand::stop), NmtState::stopped);
  for (const auto command :
       {NmtCommand::enter_pre_operational, NmtCommand::reset_node, NmtCommand::reset_communication})
    EXPECT_EQ(state_after(command), NmtState::pre_operational);
}

TEST(Nmt, StatesHaveNames) {
  EXPECT_EQ(name(NmtState::initialising), "boot-up");
  EXPECT_EQ(name(NmtState::stopped), "stopped");
  EXPECT_EQ(name(NmtState::operational), "operational");
  EXPECT_EQ(name(NmtState::pre_operational), "pre-operational");
  EXPECT_EQ(name(static_cast<NmtState>(1)), "unknown");
}

TEST(ErrorControl, TellsBootUpAndStatesAndDropsTheToggleBit) {
  EXPECT_TRUE(parse_error_control(frame("705#00"))->boot_up);
  EXPECT_EQ(parse_error_control(frame("705#05"))->state, NmtState::operational);
  EXPECT_EQ(parse_error_control(frame("705#85"))->state, NmtState::operational);
  EXPECT_FALSE(parse_error_control(frame("705#05"))->boot_up);
  EXPECT_EQ(parse_error_control(frame("701#7F"))->node, 1);
  EXPECT_EQ(parse_error_control(frame("77F#7F"))->node, 127);
  for (const auto* text : {"700#05", "780#05", "705#", "705#0500", "705#R", "705#R1", "00000705#05"})
    EXPECT_FALSE(parse_error_control(frame(text))) << text;
}

}  // namespace
}  // namespace servoctl::canopen
