// A simulated drive as an LSS slave (CiA 305). The frames are written down from the figures of the standard
// as other stacks carry them.
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class LssDrive : public CellTest {
 protected:
  /// Everything that is said within a while.
  std::vector<std::string> heard(Duration patience = 10ms) {
    std::vector<std::string> out;
    for (auto line = next(patience); !line.empty(); line = next(patience)) out.push_back(line);
    return out;
  }
  std::vector<std::string> answers(std::string_view frame) {
    send(frame);
    return heard();
  }
  using Lines = std::vector<std::string>;
};

TEST_F(LssDrive, WithoutANodeIdSaysNothingUntilItIsAskedByLss) {
  build("sv2@255?lss");
  EXPECT_EQ(heard(2s), Lines());
  EXPECT_EQ(answers("67F#4000100000000000"), Lines());
  EXPECT_EQ(answers("000#8100"), Lines());
  EXPECT_EQ(heard(2s), Lines());
  EXPECT_EQ(answers("7E5#4C00000000000000"), Lines{"7E4#5000000000000000"});
}

TEST_F(LssDrive, IsSelectedByItsWholeIdentityAlone) {
  build("sv2@1?lss");
  (void)heard(1s);
  for (const auto* wrong :
       {"7E5#4053564401000000", "7E5#4101000000000000", "7E5#4201000000000000", "7E5#4301000000000000"})
    EXPECT_EQ(answers(wrong), Lines());
  EXPECT_EQ(answers("7E5#5E00000000000000"), Lines()) << "it waits";
  for (const auto* right : {"7E5#4053564400000000", "7E5#4101000000000000", "7E5#4201000000000000"})
    EXPECT_EQ(answers(right), Lines());
  EXPECT_EQ(answers("7E5#4301000000000000"), Lines{"7E4#4400000000000000"});
  EXPECT_EQ(answers("7E5#5E00000000000000"), Lines{"7E4#5E01000000000000"});
  EXPECT_EQ(answers("7E5#5A00000000000000"), Lines{"7E4#5A53564400000000"});
  EXPECT_EQ(answers("7E5#5D00000000000000"), Lines{"7E4#5D01000000000000"});
  EXPECT_EQ(answers("601#4018100400000000"), Lines{"581#4318100401000000"}) << "1018h says the same";
  EXPECT_EQ(answers("7E5#0400000000000000"), Lines());
  EXPECT_EQ(answers("7E5#5E00000000000000"), Lines());
}

TEST_F(LssDrive, StartsWithItsFirstNodeIdWhenLssGoesBackToWaiting) {
  build("gsd600@255?lss");
  EXPECT_EQ(answers("7E5#0401000000000000"), Lines());
  EXPECT_EQ(answers("7E5#1180000000000000"), Lines{"7E4#1101000000000000"});
  EXPECT_EQ(answers("7E5#1105000000000000"), Lines{"7E4#1100000000000000"});
  EXPECT_EQ(answers("7E5#4C00000000000000"), Lines()) << "it is to have one";
  EXPECT_EQ(heard(1s), Lines());
  EXPECT_EQ(answers("7E5#0400000000000000"), Lines());
  EXPECT_EQ(heard(1s), Lines{"705#00"});
  EXPECT_EQ(answers("605#4000100000000000").front().substr(0, 4), "585#");
  send("000#8105");
  EXPECT_EQ(heard(1s), Lines()) << "it was not stored";
  EXPECT_EQ(answers("7E5#4C00000000000000"), Lines{"7E4#5000000000000000"});
}

class LssMemory : public LssDrive, public testing::WithParamInterface<const char*> {};

TEST_P(LssMemory, KeepsAStoredNodeIdOverARestart) {
  build(std::string(GetParam()) + "@255?lss");
  EXPECT_EQ(answers("7E5#0401000000000000"), Lines());
  EXPECT_EQ(answers("7E5#1105000000000000"), Lines{"7E4#1100000000000000"});
  EXPECT_EQ(answers("7E5#1700000000000000"), Lines{"7E4#1700000000000000"});
  send("7E5#0400000000000000");
  EXPECT_EQ(heard(1s), Lines{"705#00"});
  send("000#8105");
  EXPECT_EQ(heard(1s), Lines{"705#00"});
}

/// With a parameter of the node-ID and without.
INSTANTIATE_TEST_SUITE_P(Families, LssMemory, testing::Values("gsd600", "cia402"));

TEST_F(LssDrive, ThatHasANodeIdTakesTheNextOneWithAResetOfItsCommunication) {
  build("gsd600@1?lss");
  (void)heard(1s);
  send("7E5#0401000000000000");
  EXPECT_EQ(answers("7E5#1107000000000000"), Lines{"7E4#1100000000000000"});
  send("7E5#0400000000000000");
  EXPECT_EQ(heard(1s), Lines());
  EXPECT_EQ(answers("601#4000100000000000").front().substr(0, 4), "581#");
  send("000#8201");
  EXPECT_EQ(heard(1s), Lines{"707#00"});
}

TEST_F(LssDrive, IsFoundByFastscanAndTakesNoFurtherPartInIt) {
  build("gsd600@255?lss");
  EXPECT_EQ(answers("7E5#5100000000800000"), Lines{"7E4#4F00000000000000"});
  drive().model().set_serial(6);
  for (const auto* number : {"7E5#5100000000000001", "7E5#5100000000000102", "7E5#5100000000000203"})
    EXPECT_EQ(answers(number).size(), 1U) << number;
  EXPECT_EQ(answers("7E5#5100000000020303"), Lines()) << "bit 2 of 6 is set";
  EXPECT_EQ(answers("7E5#5104000000010303"), Lines()) << "bit 1 as well";
  EXPECT_EQ(answers("7E5#5106000000000101"), Lines()) << "it is not asked for its product";
  EXPECT_EQ(answers("7E5#5106000000000300"), Lines{"7E4#4F00000000000000"});
  EXPECT_EQ(answers("7E5#5100000000800000"), Lines());
  EXPECT_EQ(answers("7E5#5E00000000000000"), Lines{"7E4#5EFF000000000000"});
}

TEST_F(LssDrive, TakesBitratesOfTable0AndNoOthers) {
  build("gsd600@1?lss");
  (void)heard(1s);
  send("7E5#0401000000000000");
  EXPECT_EQ(answers("7E5#1300020000000000"), Lines{"7E4#1300000000000000"});
  for (const auto* none : {"7E5#1300050000000000", "7E5#1300090000000000", "7E5#1301020000000000"})
    EXPECT_EQ(answers(none), Lines{"7E4#1301000000000000"});
  EXPECT_EQ(answers("7E5#15E8030000000000"), Lines());
}

TEST_F(LssDrive, DrivesOfOneKindDifferInTheirSerialNumbers) {
  build("sv2@255,sv2@255?lss");
  send("7E5#0401000000000000");
  EXPECT_EQ(answers("7E5#5D00000000000000"), (Lines{"7E4#5D01000000000000", "7E4#5D02000000000000"}));
}

TEST_F(LssDrive, ADriveWithoutTheOptionIsNoLssSlave) {
  build("gsd600@1");
  (void)heard(1s);
  send("7E5#0401000000000000");
  EXPECT_EQ(answers("7E5#5E00000000000000"), Lines());
}

TEST(LssCell, RefusesADriveThatNobodyCouldReach) {
  const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
  EXPECT_FALSE(build_cell("gsd600@255", folders, {}));
  EXPECT_FALSE(build_cell("gsd600@254?lss", folders, {}));
  EXPECT_FALSE(build_cell("gsd600@1,gsd600@1?lss", folders, {}));
  EXPECT_TRUE(build_cell("gsd600@255,gsd600@255?lss", folders, {}));
}

}  // namespace
}  // namespace servoctl::sim
