// Restore and clone, as a user runs them.
#include <regex>

#include "backup_fixture.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

using RestoreTest = BackupTest;

struct Change {
  const char* family;
  const char* line;
};

TEST_F(RestoreTest, IsPutBackIntoEveryFamily) {
  for (const auto& c : {Change{"da200", "param set P5.12 77"}, Change{"dm", "write 6065h 1.25"},
                        Change{"gsd600", "param set Pn0214=450 Pn0215=900"},
                        Change{"sv2", "write 2001h:1 60"}, Change{"ts", "param set Fn_33=120 Fn_3A=3"}}) {
    SCOPED_TRACE(c.family);
    use(fmt::format("sim:{}@1", c.family), c.family);
    ASSERT_EQ(run("backup %drive.json --yes"), 0);
    ASSERT_EQ(run(c.line), 0) << console.err_text;
    ASSERT_EQ(run("verify %drive.json"), 1);
    EXPECT_EQ(run("restore %drive.json"), 8) << "it asks";
    EXPECT_EQ(run("verify %drive.json"), 1);
    EXPECT_EQ(run("restore %drive.json --dry-run"), 0);
    EXPECT_EQ(run("verify %drive.json"), 1);
    ASSERT_EQ(run("restore %drive.json --yes"), 0) << console.out_text << console.err_text;
    EXPECT_EQ(run("verify %drive.json"), 0) << console.out_text;
    EXPECT_EQ(run("restore %drive.json --yes"), 0);
    EXPECT_NE(console.out_text.find("nothing differs"), std::string::npos) << console.out_text;
  }
}

TEST_F(RestoreTest, IsPutBackAfterTheFactoryValues) {
  ASSERT_EQ(run("param set Pn0214=450 Pn0202=321"), 0);
  ASSERT_EQ(run("write 605Ah 5"), 0);
  ASSERT_EQ(run("backup %mine.json"), 0);
  ASSERT_EQ(run("defaults --yes"), 0);
  ASSERT_EQ(run("nmt reset --yes --wait"), 0);
  ASSERT_EQ(run("verify %mine.json"), 1);
  ASSERT_EQ(run("restore %mine.json --yes --keep"), 0) << console.err_text;
  EXPECT_NE(console.out_text.find("kept       yes"), std::string::npos) << console.out_text;
  ASSERT_EQ(run("nmt reset --yes --wait"), 0);
  EXPECT_EQ(run("verify %mine.json"), 0) << console.out_text;
  EXPECT_TRUE(fs::exists(folder / "mine.json.before-node-1.json"));
  EXPECT_EQ(run("restore %mine.json.before-node-1.json --yes"), 0);
}

/// 0 is the broadcast address, with which a drive answers nobody on Modbus; on CAN it is a value like
/// another.
TEST_F(RestoreTest, AModbusAddressOfZeroGoesBackOverCanAndStaysWithItsOwnDrive) {
  use("sim:ts@1,ts@2", "ts");
  ASSERT_EQ(run("param set Fn_3A=0 -n 1"), 0) << console.err_text;
  ASSERT_EQ(run("backup %silent.json -n 1"), 0);
  for (const auto* node : {"1", "2"}) {
    ASSERT_EQ(run(fmt::format("param set Fn_3A=3 -n {}", node)), 0) << console.err_text;
    ASSERT_EQ(run(fmt::format("restore %silent.json --yes -n {}", node)), 0) << console.err_text;
  }
  EXPECT_EQ(run("param get Fn_3A -n 1 --json"), 0);
  EXPECT_NE(console.out_text.find("\"raw\":0,"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("param get Fn_3A -n 2 --json"), 0);
  EXPECT_NE(console.out_text.find("\"raw\":3,"), std::string::npos) << console.out_text;
}

TEST_F(RestoreTest, GoesIntoAnotherNodeWithItsOwnAddresses) {
  use("sim:gsd600@1,gsd600@5", "gsd600");
  ASSERT_EQ(run("param set Pn0214 450"), 0);
  ASSERT_EQ(run("backup %one.json"), 0);
  ASSERT_EQ(run("restore %one.json --yes -n 5"), 0) << console.out_text << console.err_text;
  EXPECT_NE(console.out_text.find("different  1"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("param get Pn0214 Pn0049 -n 5 --json"), 0);
  EXPECT_NE(console.out_text.find("\"raw\":450"), std::string::npos);
  EXPECT_NE(console.out_text.find("\"raw\":5,"), std::string::npos);
}

TEST_F(RestoreTest, GoesFromOneDriveIntoOthersWithoutAFile) {
  use("sim:gsd600@1,gsd600@2,gsd600@3", "gsd600");
  const auto here = fs::current_path();
  fs::current_path(folder);
  ASSERT_EQ(run("param set Pn0214=450 Pn0202=321"), 0);
  EXPECT_EQ(run("clone --from 1 --to 2,3"), 8) << "it asks";
  EXPECT_EQ(run("clone --from 1 --to 2,1 --yes"), 2);
  EXPECT_EQ(run("clone --from 1 --to 200 --yes"), 2);
  EXPECT_EQ(run("clone --from 9 --to 2 --yes --timeout 20ms"), 4);
  EXPECT_EQ(run("clone --from 1 --to 2,3 --yes"), 0) << console.err_text;
  EXPECT_EQ(run("param get Pn0214 -n 3 --json"), 0);
  EXPECT_NE(console.out_text.find("\"raw\":450"), std::string::npos);
  EXPECT_EQ(run("clone --from 1 --to 2,3 --yes"), 0);
  EXPECT_NE(console.out_text.find("nothing differs"), std::string::npos);
  EXPECT_TRUE(fs::exists("before-clone-node-3.json"));
  fs::current_path(here);
}

TEST_F(RestoreTest, IsNotPutIntoAnEnergisedDriveNorAnotherKind) {
  ASSERT_EQ(run("backup %drive.json"), 0);
  for (const auto* word : {"6", "7", "15"}) ASSERT_EQ(run(std::string("write 0x6040 --yes ") + word), 0);
  EXPECT_EQ(run("restore %drive.json --yes"), 8);
  EXPECT_NE(console.err_text.find("energised"), std::string::npos) << console.err_text;
  use("sim:dm@1", "dm");
  EXPECT_EQ(run("restore %drive.json --yes"), 8);
  use("sim:dm@1", "gsd600");
  EXPECT_EQ(run("restore %drive.json --yes"), 8);
  EXPECT_NE(console.err_text.find("node 1: not a gsd600"), std::string::npos) << console.err_text;
  // Whoever says that the family is right after all is told by the identity in the backup.
  EXPECT_EQ(run("restore %drive.json --yes --force-family"), 8);
  EXPECT_NE(console.err_text.find("is not the drive"), std::string::npos) << console.err_text;
}

TEST_F(RestoreTest, IsNotRestoredWhenItWasEdited) {
  ASSERT_EQ(run("backup %drive.json --only gain"), 0);
  // The same file as an editor without scruples would leave it: a value beyond its limits, and a checksum
  // that fits.
  auto text = replaced(slurp("drive.json"), "\"bytes\":\"90 01\"", "\"bytes\":\"FF FF\"");
  spill("wild.json", text);
  EXPECT_EQ(run("restore %wild.json --yes"), 7);
  EXPECT_EQ(run("verify %drive.json"), 0);
}

TEST_F(RestoreTest, WritesNoMemorySwitchAndNoPasswordWhateverTheFileSays) {
  struct Case {
    const char* family;
    const char* change;
    const char* look;  ///< Shows the switch.
    const char* reason;
  };
  for (const auto& c : {Case{"ts", "param set Fn_33=120", "param get Fn_99 --json", "memory switch"},
                        Case{"sv2", "write 2001h:1 60", "read 2005h:3 --json", "memory switch"}}) {
    SCOPED_TRACE(c.family);
    use(fmt::format("sim:{}@1", c.family), c.family);
    ASSERT_EQ(run("backup %drive.json --yes"), 0);
    EXPECT_NE(slurp("drive.json").find(c.reason), std::string::npos);
    ASSERT_EQ(run(c.change), 0);
    ASSERT_EQ(run(c.look), 0);
    const auto before = console.out_text;
    ASSERT_EQ(run("restore %drive.json --yes --keep"), 0) << console.err_text;
    EXPECT_NE(console.out_text.find("kept       yes"), std::string::npos) << console.out_text;
    ASSERT_EQ(run(c.look), 0);
    EXPECT_EQ(console.out_text, before);
    EXPECT_EQ(run("verify %drive.json"), 0);
    ASSERT_EQ(run("nmt reset --yes --wait"), 0);
    EXPECT_EQ(run("verify %drive.json"), 0) << console.out_text;
  }
}

TEST_F(RestoreTest, MakesAFactoryDriveOfEveryFamilyTheSame) {
  for (const auto& c : {Change{"da200", "param set P5.12 77"}, Change{"dm", "write 6065h 1.25"},
                        Change{"gsd600", "param set Pn0214=450 Pn0215=900"},
                        Change{"sv2", "write 2001h:1 60"}, Change{"ts", "param set Fn_33=120 Fn_3A=3"}}) {
    SCOPED_TRACE(c.family);
    use(fmt::format("sim:{}@1", c.family), c.family);
    ASSERT_EQ(run(c.line), 0) << console.err_text;
    ASSERT_EQ(run("backup %drive.json --yes"), 0);
    // Another drive, as it comes from the factory.
    use(fmt::format("sim:{}@1", c.family), c.family);
    ASSERT_EQ(run("verify %drive.json"), 1);
    ASSERT_EQ(run("restore %drive.json --yes"), 0) << console.out_text << console.err_text;
    EXPECT_EQ(run("diff %drive.json node:1"), 0) << console.out_text;
  }
}

TEST_F(RestoreTest, KeepsWhatTheDriveHeldInItsRamAlready) {
  for (const auto& c : {Change{"ts", "param set Fn_33=120"}, Change{"sv2", "write 2001h:1 60"}}) {
    SCOPED_TRACE(c.family);
    use(fmt::format("sim:{}@1", c.family), c.family);
    ASSERT_EQ(run(c.line), 0);
    ASSERT_EQ(run("backup %drive.json --yes"), 0);
    ASSERT_EQ(run("restore %drive.json --yes --keep"), 0) << console.err_text;
    EXPECT_NE(console.err_text.find("every value is written to flash"), std::string::npos);
    ASSERT_EQ(run("nmt reset --yes --wait"), 0);
    EXPECT_EQ(run("verify %drive.json"), 0) << console.out_text;
  }
}

TEST_F(RestoreTest, ThatWasCutOffIsNotBegunAnew) {
  const auto journal = folder / "drive.json.before-node-1.json.journal";
  ASSERT_EQ(run("backup %drive.json --only gain"), 0);
  EXPECT_EQ(run("restore %drive.json --yes --resume"), 2) << "nothing was cut off";
  int code = 0;
  for (int time = 100; !fs::exists(journal); time += 10) {
    ASSERT_LT(time, 5000);
    use(fmt::format("sim:gsd600@1?delay=5ms&silent={}ms", time), "gsd600");
    (void)run("param set Pn0214=450 Pn0215=900");
    code = run("restore %drive.json --yes");
  }
  EXPECT_EQ(code, 4);
  EXPECT_NE(console.err_text.find("--resume continues"), std::string::npos) << console.err_text;
  const auto saved = slurp("drive.json.before-node-1.json");

  use("sim:gsd600@1", "gsd600");
  ASSERT_EQ(run("param set Pn0215=900"), 0);
  EXPECT_EQ(run("restore %drive.json --yes"), 8);
  EXPECT_NE(console.err_text.find("was interrupted"), std::string::npos) << console.err_text;
  EXPECT_EQ(slurp("drive.json.before-node-1.json"), saved);
  EXPECT_EQ(run("restore %drive.json --yes --resume"), 8) << "no serial number tells that it is that drive";
  spill("drive.json.before-node-1.json",
        std::regex_replace(saved, std::regex("sim:gsd600@1[^\"]*"), "sim:gsd600@1"));
  EXPECT_EQ(run("restore %drive.json --yes"), 8);
  EXPECT_NE(console.err_text.find("drive.json to node 1 was interrupted"), std::string::npos);
  EXPECT_EQ(run("restore %drive.json --yes --resume"), 0) << console.err_text;
  EXPECT_EQ(run("verify %drive.json"), 0);
  EXPECT_FALSE(fs::exists(journal));

  spill("drive.json.before-node-1.json.journal", "{}");
  EXPECT_EQ(run("restore %drive.json --yes"), 7) << "no journal that anyone could go by";
}

TEST_F(RestoreTest, WritesNothingThatThisDriveCallsNoSetting) {
  // Taken with data of the family that did not know the memory switch yet.
  for (const auto& file : fs::directory_iterator(eds / "sinsegye")) fs::copy(file.path(), folder);
  auto rules = slurp("sv2.toml");
  for (const auto* key : {"flash_switch", "to_ram", "to_flash"})
    rules = replaced(rules, fmt::format("\n{} =", key), fmt::format("\n# {} =", key));
  spill("sv2.toml", rules);
  use("sim:sv2@1", "sv2");
  ASSERT_EQ(run("backup %drive.json"), 0) << console.err_text;
  for (const auto& file : fs::directory_iterator(eds / "sinsegye"))
    fs::remove(folder / file.path().filename());
  use("sim:sv2@1", "sv2");
  ASSERT_EQ(run("write 2001h:1 60"), 0);
  EXPECT_EQ(run("restore %drive.json --yes"), 8);
  EXPECT_NE(console.err_text.find("0x2005:3 is not a setting of this drive: memory switch"),
            std::string::npos)
      << console.err_text;
  EXPECT_EQ(run("verify %drive.json"), 1) << "nothing was written";
  EXPECT_EQ(run("restore %drive.json --yes --force"), 0) << console.err_text;
  EXPECT_NE(console.err_text.find("left out"), std::string::npos) << console.err_text;
  ASSERT_EQ(run("verify %drive.json"), 1);
  EXPECT_NE(console.out_text.find("different  1\n"), std::string::npos)
      << "the switch alone: " << console.out_text;
}

}  // namespace
}  // namespace servoctl::cli
