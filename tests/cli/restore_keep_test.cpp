// What `restore --keep` says of values that may be gone after a restart.
#include "backup_fixture.hpp"

namespace servoctl::cli {
namespace {

class RestoreKeepTest : public BackupTest {
 protected:
  void file(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
  bool told(std::string_view text) const { return console.err_text.find(text) != std::string::npos; }
  bool shown(std::string_view text) const { return console.out_text.find(text) != std::string::npos; }
  std::size_t files() const {
    const std::filesystem::directory_iterator all(folder);
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }
};

TEST_F(RestoreKeepTest, SaysNothingOfWhatNoManualCallsKept) {
  file("k.txt", "write 0x6083 4321 --type u32\n");
  for (const auto* family : {"ts", "sv2"}) {
    SCOPED_TRACE(family);
    use(fmt::format("sim:{}@1", family), family);
    ASSERT_EQ(run("restore %k.txt --keep --yes --json"), 0) << console.out_text;
    EXPECT_TRUE(shown(R"("kept":null)")) << console.out_text;
    EXPECT_TRUE(shown("does not say whether these survive power-off: 0x6083")) << console.out_text;
  }
  file("p.txt", "write 0x2095 500 --type u16\n");
  use("sim:ts@1", "ts");
  ASSERT_EQ(run("restore %p.txt --keep --yes --json"), 0) << console.out_text;
  EXPECT_TRUE(shown(R"("kept":true)")) << console.out_text;
}

TEST_F(RestoreKeepTest, TellsWhatTheDriveReplacesAtItsStart) {
  use("sim:gsd600@1", "gsd600");
  ASSERT_EQ(run("write 0x1017 300"), 0);
  ASSERT_EQ(run("backup %full.json"), 0);
  const std::string_view what =
      "0x1017:0 is 300 only until a restart: the drive then takes it from Pn0116, which ";
  ASSERT_EQ(run("restore %full.json --keep --dry-run"), 0);
  EXPECT_TRUE(told(what)) << console.err_text;
  ASSERT_EQ(run("restore %full.json --keep --yes"), 0);
  EXPECT_TRUE(told(what) && told("full.json says is 0")) << console.err_text;
  EXPECT_TRUE(!shown("kept       yes")) << console.out_text;
  ASSERT_EQ(run("nmt reset --yes --wait"), 0);
  ASSERT_EQ(run("read 0x1017 --json"), 0);
  EXPECT_TRUE(shown(R"("raw":0)")) << console.out_text;
  // A file that contradicts itself in nothing is kept.
  ASSERT_EQ(run("backup %whole.json"), 0);
  ASSERT_EQ(run("param set Pn0214=450"), 0);
  ASSERT_EQ(run("restore %whole.json --keep --yes"), 0);
  EXPECT_TRUE(shown("kept       yes")) << console.out_text << console.err_text;
}

TEST_F(RestoreKeepTest, DoneTwiceLeavesTheOldValuesInTheirFile) {
  use("sim:gsd600@1", "gsd600");
  ASSERT_EQ(run("backup %good.json"), 0);
  ASSERT_EQ(run("param set Pn0214=70Hz Pn0202=33"), 0);
  ASSERT_EQ(run("restore %good.json --keep --yes"), 0);
  EXPECT_TRUE(told("the old values of node 1 are in")) << console.err_text;
  ASSERT_EQ(run("restore %good.json --keep --yes"), 0);
  EXPECT_TRUE(shown("nothing differs; stored")) << console.out_text;
  EXPECT_FALSE(told("old values")) << console.err_text;
  ASSERT_EQ(run("restore %good.json.before-node-1.json --yes"), 0);
  EXPECT_TRUE(shown("different  2")) << console.out_text;
}

TEST_F(RestoreKeepTest, AFamilyThatCannotStoreIsToldBeforeTheFirstWrite) {
  use("sim:da200@1", "da200");
  ASSERT_EQ(run("backup %drive.json"), 0);
  ASSERT_EQ(run("param set P5.12 77"), 0);
  const auto before = files();
  for (const auto* line : {"restore %drive.json --keep --yes", "restore %drive.json --keep --dry-run"}) {
    EXPECT_EQ(run(line), 1) << line;
    EXPECT_TRUE(told("cannot be told to keep values")) << console.err_text;
  }
  EXPECT_EQ(files(), before);
  EXPECT_EQ(run("verify %drive.json"), 1);
  EXPECT_EQ(run("restore %drive.json --yes"), 0) << console.err_text;
  EXPECT_EQ(run("verify %drive.json"), 0);
}

TEST_F(RestoreKeepTest, LeavesAWayOutWhereTheDriveRefusesToStore) {
  use("sim:da200@1", "cia402");
  file("q.txt", "write 0x6083 5000 --type u32\n");
  EXPECT_EQ(run("restore %q.txt --keep --yes --force-family"), 5) << console.err_text;
  EXPECT_TRUE(told("storing them failed") && !told("--resume")) << console.err_text;
  EXPECT_FALSE(std::filesystem::exists(folder / "q.txt.before-node-1.json.journal"));
  EXPECT_EQ(run("restore %q.txt.before-node-1.json --yes --force-family"), 0) << console.err_text;
  ASSERT_EQ(run("read 0x6083 --json --force-family"), 0) << console.err_text;
  EXPECT_TRUE(shown(R"("raw":0)")) << console.out_text;
}

TEST_F(RestoreKeepTest, ADryRunShowsMemoryPasswordAndStoring) {
  use("sim:gsd600@1", "gsd600");
  file("k.txt", "write 0x1017 300 --type u16\n");
  ASSERT_EQ(run("restore %k.txt --keep --dry-run"), 0) << console.err_text;
  EXPECT_TRUE(shown("0x1017:0") && shown("0x1010:1") && shown("Pn0116")) << console.out_text;
  ASSERT_EQ(run("restore %k.txt --dry-run"), 0);
  EXPECT_TRUE(shown("0x1017:0") && !shown("0x1010:1")) << console.out_text;
  use("sim:ts@1", "ts");
  file("p.txt", "write 0x2095 500 --type u16\n");
  ASSERT_EQ(run("param set Fn_95=300"), 0) << console.err_text;  // Which chooses the RAM.
  const auto rows = [this] {
    const auto from = console.out_text.find(R"("result")");
    return console.out_text.substr(from, console.out_text.find(R"("notices")") - from);
  };
  ASSERT_EQ(run("restore %p.txt --keep --dry-run --json"), 0) << console.err_text;
  EXPECT_TRUE(shown("Fn_99")) << console.out_text;
  const auto restored = rows();
  ASSERT_EQ(run("write 0x2095 500 --type u16 --keep --dry-run --json"), 0) << console.err_text;
  EXPECT_EQ(restored, rows());
}

TEST_F(RestoreKeepTest, AnErrorOfAStoredCopyNamesTheLineOfItsObject) {
  use("sim:gsd600@1", "gsd600");
  file("cob.txt", "write 0x1400:1 0x185 --type u32\n");
  EXPECT_NE(run("restore %cob.txt --keep --yes"), 0);
  EXPECT_TRUE(told("cob.txt:1: ")) << console.err_text;
  EXPECT_FALSE(told(":0: ")) << console.err_text;
}

}  // namespace
}  // namespace servoctl::cli
