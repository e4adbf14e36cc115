// What `--keep` says of each value of a drive whose switch sends writes to the flash.
#include "backup_fixture.hpp"

namespace servoctl::cli {
namespace {

class ParamKeepTest : public BackupTest {
 protected:
  bool shown(std::string_view text) const { return console.out_text.find(text) != std::string::npos; }
};

TEST_F(ParamKeepTest, CallsAValueKeptThatIsInTheFlashThoughAnotherWasRefused) {
  use("sim:ts@1", "ts");
  ASSERT_EQ(run("param set Fn_31=77"), 0) << console.err_text;  // Which chooses the RAM.
  EXPECT_EQ(run("param set Fn_30=40 Fn_00=1 Fn_31=40 --keep"), 5) << console.out_text << console.err_text;
  EXPECT_TRUE(shown("40 ")) << console.out_text;
  EXPECT_FALSE(shown("read back  no")) << console.out_text;
  EXPECT_EQ(run("param set Fn_30=41 Fn_00=1 Fn_31=41 --keep --json"), 5) << console.out_text;
  EXPECT_FALSE(shown(R"("kept":false)")) << console.out_text;
  EXPECT_TRUE(shown(R"("kept":true)") && shown(R"("kept":null)")) << console.out_text;
  ASSERT_EQ(run("nmt reset --yes --wait"), 0) << console.err_text;
  ASSERT_EQ(run("param get Fn_30 Fn_31 --json"), 0) << console.err_text;
  EXPECT_FALSE(shown(R"("raw":77)")) << console.out_text;
  EXPECT_TRUE(shown(R"("raw":41)")) << console.out_text;
}

TEST_F(ParamKeepTest, CallsAValueInTheRamNotKeptThoughAnotherWasRefused) {
  use("sim:ts@1", "ts");
  EXPECT_EQ(run("param set Fn_30=40 Fn_00=1 --json"), 5) << console.out_text;
  EXPECT_TRUE(shown(R"("kept":false)") && !shown(R"("kept":true)")) << console.out_text;
}

}  // namespace
}  // namespace servoctl::cli
