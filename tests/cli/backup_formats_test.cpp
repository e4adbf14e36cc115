// Backups in every format, and files of other tools, as a user takes and puts them back.
#include "backup_fixture.hpp"
#include "base/bytes.hpp"

namespace servoctl::cli {
namespace {

struct Changed {
  const char* family;
  const char* line;
};
constexpr Changed kChanged[] = {{"da200", "param set P5.12 77"},
                                {"dm", "write 6065h 1.25"},
                                {"gsd600", "param set Pn0214=450 Pn0215=900"},
                                {"sv2", "write 2001h:1 60"},
                                {"ts", "param set Fn_33=120 Fn_3A=3"}};
constexpr const char* kOutside =
    "notice: 0x6098:0 Homing method is outside of its limits 1..35 and not in the DCF (00): use JSON to keep "
    "it\n";
constexpr const char* kFormats[] = {"json", "dcf", "csv", "servoctl"};

TEST_F(BackupTest, InEveryFormatIsWhatTheDriveHolds) {
  for (const auto& c : kChanged) {
    SCOPED_TRACE(c.family);
    use(fmt::format("sim:{}@1", c.family), c.family);
    ASSERT_EQ(run("backup %first.json --yes"), 0);
    for (const std::string format : kFormats) {
      SCOPED_TRACE(format);
      ASSERT_EQ(run("backup %drive." + format + " --yes"), 0) << console.err_text;
      // What this drive holds outside of its limits no other tool may put into a drive: DCF and table leave
      // it out, and that is told.
      const bool kept = std::string_view(c.family) != "da200" || format == "json" || format == "servoctl";
      const auto said = kept || format == "csv" ? "" : kOutside;
      if (format == "servoctl")
        EXPECT_NE(console.err_text.find("drive.servoctl has lines for "), std::string::npos);
      else
        EXPECT_EQ(console.err_text, said);
      EXPECT_EQ(run("verify %drive." + format), 0) << console.out_text << console.err_text;
      if (format == "servoctl") continue;
      EXPECT_EQ(run("diff %first.json %drive." + format), kept ? 0 : 1)
          << console.out_text << console.err_text;
      if (kept) continue;
      EXPECT_NE(console.out_text.find("different  1\n"), std::string::npos) << console.out_text;
      EXPECT_NE(console.out_text.find("0x6098:0  Homing method  0 "), std::string::npos) << console.out_text;
    }
    EXPECT_EQ(run("run %drive.servoctl --check"), 0) << console.err_text;
  }
}

TEST_F(BackupTest, InEveryFormatIsPutBackIntoEveryFamily) {
  for (const auto& c : kChanged)
    for (const std::string format : kFormats) {
      SCOPED_TRACE(c.family + (" as " + format));
      use(fmt::format("sim:{}@1", c.family), c.family);
      ASSERT_EQ(run("backup %all.json --yes"), 0);
      ASSERT_EQ(run("backup %drive." + format + " --yes"), 0);
      ASSERT_EQ(run(c.line), 0) << console.err_text;
      ASSERT_EQ(run("verify %drive." + format), 1);
      ASSERT_EQ(run("restore %drive." + format + " --yes"), 0) << console.out_text << console.err_text;
      EXPECT_EQ(run("verify %all.json"), 0) << console.out_text;
    }
}

TEST_F(BackupTest, InEveryFormatGoesIntoAnotherNodeWithItsOwnAddresses) {
  for (const std::string format : kFormats) {
    SCOPED_TRACE(format);
    use("sim:gsd600@1,gsd600@5", "gsd600");
    ASSERT_EQ(run("param set Pn0214 450"), 0);
    ASSERT_EQ(run("backup %one." + format), 0);
    ASSERT_EQ(run("restore %one." + format + " --yes -n 5"), 0) << console.out_text << console.err_text;
    EXPECT_NE(console.out_text.find("different  1\n"), std::string::npos) << console.out_text;
    EXPECT_EQ(run("diff node:1 node:5"), 0) << console.out_text;
  }
}

TEST_F(BackupTest, AsABatchIsReplayedOnADriveFromTheFactory) {
  for (const auto& c : kChanged) {
    SCOPED_TRACE(c.family);
    use(fmt::format("sim:{}@1", c.family), c.family);
    ASSERT_EQ(run(c.line), 0);
    ASSERT_EQ(run("backup %mine.json --yes"), 0);
    ASSERT_EQ(run("backup %mine.servoctl --yes"), 0);
    use(fmt::format("sim:{}@1", c.family), "");
    ASSERT_EQ(run(fmt::format("verify %mine.json -d {}", c.family)), 1);
    EXPECT_EQ(run("run %mine.servoctl"), 0) << console.err_text;
    EXPECT_EQ(run(fmt::format("verify %mine.json -d {}", c.family)), 0) << console.out_text;
  }
}

TEST_F(BackupTest, TakesTheFormatFromTheOptionOrTheName) {
  use("sim:gsd600@1,gsd600@2", "gsd600");
  ASSERT_EQ(run("backup %cabinet -n 1,2 --format csv"), 0);
  EXPECT_EQ(slurp("cabinet/node-2.csv").substr(0, 11), "node,index,");
  ASSERT_EQ(run("backup %x.json --format dcf"), 0);
  EXPECT_EQ(slurp("x.json").substr(0, 10), "[FileInfo]");
  ASSERT_EQ(run("backup %x.txt"), 0);
  EXPECT_EQ(slurp("x.txt").substr(0, 10), "# Settings");
  ASSERT_EQ(run("backup %x"), 0);
  EXPECT_EQ(slurp("x").substr(0, 18), "{\"servoctl_backup\"");
  EXPECT_EQ(run("verify %x"), 0);
  EXPECT_EQ(run("backup %y --format xml"), 2);
}

TEST_F(BackupTest, OfWhatWasChangedLeavesTheFactoryValuesOut) {
  ASSERT_EQ(run("param set Pn0214=450"), 0);
  ASSERT_EQ(run("backup %mine.csv --only changed"), 0);
  EXPECT_NE(slurp("mine.csv").find("Pn0214"), std::string::npos);
  EXPECT_EQ(slurp("mine.csv").find("Pn0215"), std::string::npos);
  ASSERT_EQ(run("param set Pn0214=500"), 0);
  ASSERT_EQ(run("restore %mine.csv --yes"), 0) << console.err_text;
  EXPECT_EQ(run("verify %mine.csv"), 0);
}

TEST_F(BackupTest, IsRestoredInParts) {
  ASSERT_EQ(run("backup %all.json --yes"), 0);
  ASSERT_EQ(run("param set Pn0214=450 Pn0031=1"), 0) << console.err_text;
  ASSERT_EQ(run("write 0x1017 500"), 0);
  EXPECT_EQ(run("restore %all.json --only nothing --yes"), 2);
  ASSERT_EQ(run("restore %all.json --only communication --yes"), 0) << console.err_text;
  EXPECT_EQ(run("verify %all.json"), 1);
  EXPECT_EQ(console.out_text.find("0x1017"), std::string::npos) << console.out_text;
  EXPECT_NE(console.out_text.find("Pn0214"), std::string::npos);
  ASSERT_EQ(run("restore %all.json --only gain --yes"), 0) << console.err_text;
  EXPECT_EQ(run("verify %all.json"), 1);
  EXPECT_EQ(console.out_text.find("Pn0214"), std::string::npos) << console.out_text;
  ASSERT_EQ(run("restore %all.json --only params --yes"), 0);
  EXPECT_EQ(run("verify %all.json"), 0) << console.out_text;
  ASSERT_EQ(run("backup %pdo.dcf --only pdo"), 0);
  EXPECT_EQ(run("restore %pdo.dcf --only gain --yes"), 2);
}

TEST_F(BackupTest, AsADcfIsEditedInAnotherToolAndRestored) {
  ASSERT_EQ(run("backup %drive.dcf"), 0);
  auto text = slurp("drive.dcf");
  const auto section = text.find("[2001subF]");
  ASSERT_NE(section, std::string::npos);
  const auto value = text.find("ParameterValue=600", section);
  ASSERT_NE(value, std::string::npos);
  spill("edited.dcf", text.replace(value, 18, "ParameterValue=0x1C2"));
  EXPECT_EQ(run("verify %edited.dcf"), 1);
  ASSERT_EQ(run("restore %edited.dcf --yes"), 0) << console.err_text;
  EXPECT_NE(console.err_text.find("it proves neither its drive nor its completeness"), std::string::npos);
  EXPECT_EQ(run("param get Pn0214 --json"), 0);
  EXPECT_NE(console.out_text.find("\"raw\":450"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("diff %drive.dcf %edited.dcf"), 1);
  EXPECT_NE(console.out_text.find("different  1"), std::string::npos) << console.out_text;
}

/// The beginning of a DCF as another tool would write it.
}  // namespace
}  // namespace servoctl::cli
