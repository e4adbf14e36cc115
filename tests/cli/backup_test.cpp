// Backup, diff and verify, as a user runs them.
#include "backup_fixture.hpp"
#include "drive/drive_settings.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

TEST_F(BackupTest, OfEveryFamilyIsWhatTheDriveHolds) {
  for (const auto* family : {"da200", "dm", "gsd600", "sv2", "ts"}) {
    SCOPED_TRACE(family);
    use(fmt::format("sim:{}@1", family), family);
    ASSERT_EQ(run("backup %drive.json --yes"), 0) << console.err_text;
    EXPECT_EQ(run("verify %drive.json"), 0) << console.out_text << console.err_text;
    EXPECT_EQ(run("diff %drive.json %drive.json"), 0);
    const auto text = slurp("drive.json");
    EXPECT_NE(text.find(fmt::format("\"family\":\"{}\"", family)), std::string::npos);
    EXPECT_NE(text.find("\"time\":\"2026-11-18T11:06:40Z\""), std::string::npos);
    EXPECT_NE(
        text.find(
            "\"name\":\"Controlword\",\"type\":\"u16\",\"bytes\":null,\"value\":null,\"unit\":null,\"label\":null,\"left_out\":\"process data\""),
        std::string::npos);
  }
}

TEST_F(BackupTest, ShowsWhatWasChangedSince) {
  ASSERT_EQ(run("backup %before.json"), 0);
  ASSERT_EQ(run("param set Pn0214 450"), 0);
  EXPECT_EQ(run("verify %before.json"), 1);
  EXPECT_NE(console.out_text.find("Pn0214 Speed loop gain 1  600 = 60 Hz"), std::string::npos)
      << console.out_text;
  EXPECT_NE(console.out_text.find("450 = 45 Hz"), std::string::npos);
  ASSERT_EQ(run("backup %after.json"), 0);
  EXPECT_EQ(run("diff %before.json %after.json --json"), 1);
  EXPECT_NE(console.out_text.find("\"compared\":438,\"different\":1"), std::string::npos) << console.out_text;
  EXPECT_NE(console.out_text.find("\"id\":\"Pn0214\""), std::string::npos);
  EXPECT_EQ(run("diff %after.json factory"), 1);
}

TEST_F(BackupTest, IsEmptyAgainstItselfAfterDefaults) {
  ASSERT_EQ(run("backup %factory.json"), 0);
  ASSERT_EQ(run("param set Pn0214 450"), 0);
  ASSERT_EQ(run("defaults --yes"), 0);
  ASSERT_EQ(run("nmt reset --yes --wait"), 0);
  EXPECT_EQ(run("verify %factory.json"), 0) << console.out_text;
}

TEST_F(BackupTest, OfPartsHasOnlyThose) {
  ASSERT_EQ(run("backup %params.json --only params"), 0);
  EXPECT_EQ(slurp("params.json").find("\"id\":null"), std::string::npos);
  ASSERT_EQ(run("backup %pdo.json --only pdo"), 0);
  EXPECT_EQ(slurp("pdo.json").find("\"id\":\"Pn02"), std::string::npos);
  EXPECT_NE(slurp("pdo.json").find("\"id\":\"Pn0118\""), std::string::npos) << "what survives power-off";
  ASSERT_EQ(run("backup %gain.json --only gain"), 0);
  EXPECT_NE(slurp("gain.json").find("Pn0202"), std::string::npos);
  EXPECT_EQ(run("verify %gain.json"), 0);
  EXPECT_EQ(run("backup %x.json --only nothing"), 2);
  EXPECT_FALSE(fs::exists(folder / "x.json"));
}

TEST_F(BackupTest, OfSeveralDrivesGoesIntoAFolder) {
  use("sim:gsd600@1,gsd600@2", "gsd600");
  ASSERT_EQ(run("backup %cabinet -n 1,2"), 0);
  EXPECT_TRUE(fs::exists(folder / "cabinet/node-1.json"));
  EXPECT_EQ(run("verify %cabinet/node-2.json -n 2"), 0);
}

TEST_F(BackupTest, OfADriveThatFallsSilentIsNotWritten) {
  use("sim:gsd600@1,gsd600@2?silent=300ms&delay=5ms", "gsd600");
  EXPECT_EQ(run("backup %cabinet -n 1,2"), 4);
  EXPECT_FALSE(fs::exists(folder / "cabinet/node-1.json"));
  spill("old.json", "restores the old values");
  EXPECT_EQ(run("backup %old.json --yes"), 4);
  EXPECT_EQ(slurp("old.json"), "restores the old values");
}

TEST_F(BackupTest, RecordsWhatTheDriveRefuses) {
  // The drive is a TS, taken for any CiA 402 drive: most objects are not there.
  use("sim:ts@1", "cia402");
  ASSERT_EQ(run("backup %drive.json"), 0) << console.err_text;
  EXPECT_NE(
      slurp("drive.json").find("\"left_out\":\"refused: object does not exist in the object dictionary\""),
      std::string::npos);
}

TEST_F(BackupTest, ThatWasEditedCutOrIsForeignIsRefusedWithTheReason) {
  ASSERT_EQ(run("backup %good.json"), 0);
  const auto good = slurp("good.json");
  struct Case {
    std::string text;
    const char* said;
  };
  const Case cases[] = {
      {replaced(good, "\"bytes\":\"58 02\"", "\"bytes\":\"59 02\""), "its checksum does not match"},
      {good.substr(0, good.size() / 2), "not JSON, or truncated"},
      {replaced(good, "\"servoctl_backup\":1", "\"servoctl_backup\":2"), "newer than this program supports"},
      {replaced(good, "\"index\":4108,\"sub\":0", "\"index\":4101,\"sub\":0"),
       "bad.json:5: 0x1005:0 appears twice"},
      {replaced(good, "\"type\":\"u32\"", "\"type\":\"u33\""), "bad.json:4: 'type' is missing or wrong"},
      {replaced(good, "\"bytes\":\"80 00 00 00\"", "\"bytes\":\"80 00 00\""),
       "bad.json:4: 'bytes' is missing or wrong"},
      {replaced(good, "\"index\":4101", "\"index\":74101"), "'index' is missing or wrong"},
      {replaced(good, "\"node\":1", "\"node\":0"), "'node' is missing or wrong"},
      {"[]", "this is not a servoctl backup"},
      {"", "not JSON, or truncated"},
      {std::string(100000, '['), "bad.json:1: column 65: lists and records are nested deeper"},
  };
  for (const auto& c : cases) {
    spill("bad.json", c.text);
    EXPECT_EQ(run("diff %good.json %bad.json"), 7) << c.said;
    EXPECT_NE(console.err_text.find(c.said), std::string::npos) << console.err_text;
    EXPECT_EQ(run("verify %bad.json"), 7);
  }
  EXPECT_EQ(run("verify %missing.json"), 7);
}

TEST_F(BackupTest, OfAnotherFamilyIsRefused) {
  ASSERT_EQ(run("backup %gsd.json"), 0);
  use("sim:dm@1", "dm");
  EXPECT_EQ(run("verify %gsd.json"), 8);
  ASSERT_EQ(run("backup %dm.json"), 0);
  EXPECT_EQ(run("diff %gsd.json %dm.json"), 1);
}

TEST(DriveSettings, HoldNothingThatMovesOrStartsAnything) {
  const fs::path folders[] = {fs::path(source_dir()) / "eds"};
  for (const auto* family : {"cia402", "da200", "dm", "gsd600", "sv2", "ts"}) {
    const auto profile = drive::load_profile(family, folders).value();
    std::size_t kept = 0;
    for (const auto& setting : drive::settings_of(profile)) {
      const auto& entry = *setting.entry;
      kept += setting.left_out.empty() ? 1U : 0U;
      for (const unsigned index : {0x6040U, 0x607AU, 0x60FFU, 0x6071U, 0x1010U, 0x1011U, 0x1003U})
        if (entry.address.index == index) {
          EXPECT_FALSE(setting.left_out.empty()) << family << " " << to_string(entry.address);
        }
      EXPECT_FALSE(setting.left_out.empty() && (entry.command || entry.access == od::Access::wo)) << family;
    }
    EXPECT_GT(kept, 50U) << family;
  }
}

TEST_F(BackupTest, IsReplacedOnlyAfterAQuestion) {
  const auto notes = folder / "notes.txt";
  std::ofstream(notes) << "my notes\n";
  EXPECT_EQ(run("backup %notes.txt"), 8) << console.out_text;
  EXPECT_NE(console.err_text.find("confirmation needed: Replace the file "), std::string::npos)
      << console.err_text;
  std::stringstream text;
  text << std::ifstream(notes).rdbuf();
  EXPECT_EQ(text.str(), "my notes\n");
  EXPECT_EQ(run("backup %notes.txt --yes"), 0) << console.err_text;
  EXPECT_NE(console.err_text.find("is written as batch"), std::string::npos) << console.err_text;
  std::filesystem::create_directories(folder / "cell");
  std::ofstream(folder / "cell" / "node-2.json") << "my notes\n";
  EXPECT_EQ(run("backup %cell -n 1,2"), 8) << console.out_text;
  EXPECT_FALSE(std::filesystem::exists(folder / "cell" / "node-1.json"))
      << "asked before anything is written";
  std::stringstream inside;
  inside << std::ifstream(folder / "cell" / "node-2.json").rdbuf();
  EXPECT_EQ(inside.str(), "my notes\n");
  // A backup is a file like any other.
  for (const auto* name : {"a.json", "a.dcf", "a.csv", "a.servoctl"})
    for (int time = 0; time < 2; ++time)
      EXPECT_EQ(run(fmt::format("backup %{}", name)), time == 0 ? 0 : 8) << name << console.err_text;
}

}  // namespace
}  // namespace servoctl::cli
