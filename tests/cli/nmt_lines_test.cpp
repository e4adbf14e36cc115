// NMT commands and LSS: whose drive it is, and whether anybody is there.
#include "axis_lines.hpp"

namespace servoctl::cli {
namespace {

class NmtLines : public AxisLines {
 protected:
  /// An axis whose drive has another serial number than the file says.
  void with_serial(const std::string& serial) const {
    write(
        "[bus.main]\nurl = \"sim:gsd600@1,gsd600@2?lss\"\n[axis.lift]\nbus = \"main\"\nnode = 1\n"
        "family = \"gsd600\"\nserial = \"" +
        serial + "\"\n");
  }
};

TEST_F(NmtLines, ACommandToNobodyIsNotConfirmed) {
  for (const auto* command : {"start", "preop", "reset --yes", "reset-comm --yes"}) {
    EXPECT_EQ(run(std::string("nmt ") + command + " -n 99 -b sim:gsd600@1"), 4) << command << all();
    EXPECT_TRUE(says("sent, not confirmed")) << all();
    EXPECT_EQ(run(std::string("nmt ") + command + " -n 99 -b sim:gsd600@1 --json"), 4) << all();
    EXPECT_TRUE(says(R"("ok":false)") && says(R"("confirmed":false)")) << all();
    EXPECT_TRUE(says(R"("result":"sent, not confirmed")")) << all();
  }
}

TEST_F(NmtLines, ASignOfLifeIsSaid) {
  for (const auto* command : {"start", "preop", "stop", "start", "reset --yes", "reset-comm --yes"}) {
    EXPECT_EQ(run(std::string("nmt ") + command + " -n 1 -b sim:gsd600@1 --json"), 0) << command << all();
    EXPECT_TRUE(says(R"("result":"sent; the node is there")")) << command << all();
  }
  EXPECT_EQ(run("nmt start -n 1 --wait -b sim:gsd600@1"), 4) << "it sends no heartbeat: " << all();
  EXPECT_EQ(run("nmt reset -n 1 --wait --yes -b sim:gsd600@1"), 0) << all();
  EXPECT_TRUE(says("confirmed")) << all();
}

TEST_F(NmtLines, AStoppedNodeIsNotResetBecauseItMayBeTwo) {
  constexpr const char* kPlace = "-n 1 -b sim:gsd600@1";
  for (const auto* command : {"reset", "reset --wait", "reset-comm"}) {
    ASSERT_EQ(run(fmt::format("nmt stop {}", kPlace)), 0) << all();
    const auto boots = shell->session()->watch().boots(1);
    EXPECT_EQ(run(fmt::format("nmt {} --yes {}", command, kPlace)), 8) << command << all();
    EXPECT_TRUE(says("whether two drives have its node-ID is not known") && says("`nmt preop -n 1")) << all();
    EXPECT_EQ(shell->session()->watch().boots(1), boots) << "it was not restarted";
  }
  EXPECT_EQ(run(fmt::format("nmt preop {}", kPlace)), 0) << all();
  EXPECT_EQ(run(fmt::format("nmt reset --yes {}", kPlace)), 0) << all();
}

TEST_F(NmtLines, OfAStoppedNodeThatIsSilentNothingIsKnown) {
  EXPECT_EQ(run("nmt stop -n 99 -b sim:gsd600@1"), 0) << all();
  EXPECT_TRUE(says("'stop' was sent, not confirmed: nothing was heard of the node")) << all();
}

TEST_F(NmtLines, AnAxisWithAnotherSerialNumberIsRefusedByAllThatBegins) {
  with_serial("0x00012345");
  for (const auto* line :
       {"nmt start lift", "nmt reset lift --yes", "nmt reset-comm lift --yes", "nmt start -b main -n 1,2",
        "nmt start -b main -n all", "lss set-node 9 -n lift --keep --yes", "lss store -n lift --yes",
        "lss set-bitrate 500k -n lift --yes", "lss select -n lift"}) {
    EXPECT_EQ(run(line), 8) << line << all();
    EXPECT_TRUE(says("serial number")) << line << all();
  }
  for (const auto* line : {"nmt stop lift", "nmt preop lift", "disable lift", "quick-stop lift"})
    EXPECT_NE(run(line), 8) << line << all();
  with_serial("1");
  EXPECT_EQ(run("nmt start lift"), 0) << all();
  EXPECT_EQ(run("lss set-node 9 -n lift --yes"), 0) << all();
}

TEST_F(NmtLines, AStoppedDriveWithAnotherSerialNumberIsNotStartedWithAll) {
  with_serial("0x00012345");
  ASSERT_EQ(run("nmt stop -b main -n all"), 0) << all();
  EXPECT_EQ(run("nmt start -b main -n all"), 4) << all();
  EXPECT_TRUE(says("its serial number cannot be checked")) << all();
}

TEST_F(NmtLines, CtrlCEndsTheAssignmentOfNodeIds) {
  Shell::Options options;
  options.drive_folders = {fs::path(source_dir()) / "eds"};
  options.clock = sim::SimBus::Clock::virtual_time;
  Shell* of_lines = nullptr;
  options.cancelled = [&of_lines] {
    auto* session = of_lines == nullptr ? nullptr : of_lines->session();
    return session != nullptr && session->watch().boots(5) > 0;
  };
  shell = std::make_unique<Shell>(console, options);
  of_lines = shell.get();
  shell->stay_open(true);
  EXPECT_EQ(run("lss scan --assign 5 --keep --yes -b sim:sv2@255,sv2@255?lss"), 130) << all();
  EXPECT_TRUE(says("not reached")) << all();
  EXPECT_EQ(shell->session()->watch().boots(6), 0U) << all();
}

TEST_F(NmtLines, AnAssignmentThatGaveNothingIsNoSuccess) {
  EXPECT_EQ(run("lss scan --assign 5 --yes -b sim:gsd600@1?lss"), 1) << all();
  EXPECT_TRUE(says("no node-ID was given")) << all();
}

}  // namespace
}  // namespace servoctl::cli
