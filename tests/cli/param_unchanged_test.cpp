// `param set` of a value that the drive holds: nothing is written.
#include "backup_fixture.hpp"

namespace servoctl::cli {
namespace {

class ParamUnchangedTest : public BackupTest {
 protected:
  /// How many frames of the line begin so.
  std::size_t sent(const std::string& line, std::string_view frame, int exit_code = 0) {
    const auto trace = fmt::format("trace-{}.log", traces_++);
    EXPECT_EQ(run(fmt::format("{} --trace %{} --yes", line, trace)), exit_code)
        << console.out_text << console.err_text;
    std::ifstream file(folder / trace);
    std::size_t count = 0;
    for (std::string text; std::getline(file, text);)
      count += text.find(frame) != std::string::npos ? 1U : 0U;
    return count;
  }
  bool shown(std::string_view text) const { return console.out_text.find(text) != std::string::npos; }

 private:
  int traces_ = 0;
};

TEST_F(ParamUnchangedTest, AnEqualValueIsNotWritten) {
  use("sim:gsd600@1", "gsd600");
  EXPECT_EQ(sent("param set Pn0214=60Hz", "601#2B01200F"), 0U);
  EXPECT_TRUE(shown("unchanged")) << console.out_text;
  EXPECT_EQ(sent("param set Pn0214=60Hz --json", "601#2B01200F"), 0U);
  EXPECT_TRUE(shown(R"("written":true,"changed":false,"read_back":true)")) << console.out_text;
  EXPECT_EQ(sent("param set Pn0214=45Hz --json", "601#2B01200F"), 1U);
  EXPECT_TRUE(shown(R"("written":true,"changed":true,"read_back":true)")) << console.out_text;
}

TEST_F(ParamUnchangedTest, OnlyTheOthersOfALineAreWritten) {
  use("sim:gsd600@1", "gsd600");
  EXPECT_EQ(sent("param set Pn0214=60Hz Pn0202=50Hz", "601#2B012"), 1U);
  EXPECT_TRUE(shown("unchanged") && shown("Pn0202")) << console.out_text;
}

TEST_F(ParamUnchangedTest, ItIsStoredAllTheSame) {
  use("sim:gsd600@1", "gsd600");
  EXPECT_EQ(sent("param set Pn0214=60Hz --keep", "601#2B01200F"), 0U);
  EXPECT_EQ(sent("param set Pn0214=60Hz --keep", "601#2310100173617665"), 1U);
  EXPECT_TRUE(shown("unchanged") && shown("yes")) << console.out_text;
}

TEST_F(ParamUnchangedTest, AValueInTheRamIsWrittenToTheFlash) {
  use("sim:ts@1", "ts");
  ASSERT_EQ(run("param set Fn_103=77"), 0) << console.err_text;  // Which chooses the RAM.
  ASSERT_EQ(run("param set Fn_103=77"), 0) << console.err_text;
  EXPECT_TRUE(shown("unchanged")) << console.out_text;
  ASSERT_EQ(run("param set Fn_103=77 --keep --yes"), 0) << console.err_text;
  EXPECT_TRUE(shown("written, read back  yes")) << console.out_text;
  ASSERT_EQ(run("nmt reset --yes --wait"), 0) << console.err_text;
  ASSERT_EQ(run("param get Fn_103 --json"), 0) << console.err_text;
  EXPECT_TRUE(shown(R"("raw":77)")) << console.out_text;
}

TEST_F(ParamUnchangedTest, WhatIsMoreThanAValueIsAlwaysWritten) {
  use("sim:gsd600@1", "gsd600");
  EXPECT_EQ(sent("param set Pn0004=0", "601#2B002005"), 1U) << "starts an action";
  EXPECT_EQ(sent("param set Pn0049=1", "601#2B002032"), 1U) << "the node-ID";
  EXPECT_EQ(sent("param set Pn0600=0", "601#2B0320"), 1U) << "takes the motor its power";
  EXPECT_EQ(sent("write Pn0214 60Hz", "601#2B01200F"), 1U) << "the object itself";
  use("sim:ts@1", "ts");
  EXPECT_EQ(sent("param set Fn_38=0", "601#2B3820"), 1U) << "disables";
  EXPECT_EQ(sent("param set Fn_30=0", "601#2B3020"), 1U) << "the manual does not say what it does";
  EXPECT_EQ(sent("param set Fn_00=2", "601#2B0020", 5), 1U) << "protected by the password";
}

TEST_F(ParamUnchangedTest, ADryRunSaysSo) {
  use("sim:gsd600@1", "gsd600");
  EXPECT_EQ(run("param set Pn0214=60Hz Pn0202=50Hz --dry-run"), 0);
  EXPECT_TRUE(shown("Pn0202") && !shown("Pn0214")) << console.out_text;
  EXPECT_NE(console.err_text.find("Pn0214 Speed loop gain 1 is unchanged"), std::string::npos)
      << console.err_text;
}

}  // namespace
}  // namespace servoctl::cli
