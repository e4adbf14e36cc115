// diff of files, drives and factory values, and the command lines between them.
#include "backup_fixture.hpp"

namespace servoctl::cli {
namespace {

TEST_F(BackupTest, IsComparedWithDrivesAndTheFactory) {
  use("sim:gsd600@1,gsd600@2", "gsd600");
  ASSERT_EQ(run("backup %one.json"), 0);
  EXPECT_EQ(run("diff node:1 node:2"), 0) << "COB-IDs and node-ID are each node's own\n" << console.out_text;
  ASSERT_EQ(run("param set Pn0214 450 -n 2"), 0);
  EXPECT_EQ(run("diff node:1 node:2 --json"), 1);
  EXPECT_NE(console.out_text.find("\"different\":1,"), std::string::npos) << console.out_text;
  EXPECT_NE(console.out_text.find("\"bus\":\"sim:gsd600@1,gsd600@2\""), std::string::npos);
  EXPECT_EQ(run("diff %one.json node:1"), 0) << console.out_text;
  EXPECT_EQ(run("diff node:2 %one.json"), 1);
  EXPECT_EQ(run("diff factory node:1 --json"), 0);
  EXPECT_NE(console.out_text.find("\"different\":0,"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("diff node:2 factory"), 1);
  EXPECT_EQ(run("diff node:200 factory"), 2);
  EXPECT_EQ(run("diff node:9 factory --timeout 20ms"), 4);
  EXPECT_EQ(run("diff 1 factory"), 7);
  EXPECT_NE(console.err_text.find("node:1"), std::string::npos) << console.err_text;
  use("", "");
  EXPECT_EQ(run("diff factory factory"), 2);
  EXPECT_EQ(run("diff %one.json factory"), 0) << console.out_text;
  EXPECT_EQ(run("diff %one.json node:1"), 2) << "no bus is named";
}

TEST_F(BackupTest, GivesTheLinesThatLeadFromOneToAnother) {
  use("sim:gsd600@1,gsd600@2", "gsd600");
  ASSERT_EQ(run("param set Pn0214=450 Pn0202=321 -n 2"), 0);
  for (const auto* line :
       {"write 0x1800:1 0xC0000182 -n 2", "write 0x1A00:0 0 -n 2", "write 0x1A00:1 0x60410010 -n 2",
        "write 0x1A00:2 0x60640020 -n 2", "write 0x1A00:0 2 -n 2", "write 0x1800:1 0x40000182 -n 2"})
    ASSERT_EQ(run(line), 0) << console.err_text;
  EXPECT_EQ(run("diff node:1 node:2 --batch"), 1);
  EXPECT_EQ(console.out_text,
            "drive gsd600\n"
            "use 1\n"
            "param set Pn0202=321  # Position loop gain 1\n"
            "param set Pn0214=450  # Speed loop gain 1\n"
            "write 0x1800:1 0xC0000181  # COB-ID used by TPDO\n"
            "write 0x1A00:0 0  # Number of mapped objects\n"
            "write 0x1A00:1 0x60410010  # Mapped object 1\n"
            "write 0x1A00:2 0x60640020  # Mapped object 2\n"
            "write 0x1A00:0 2  # Number of mapped objects\n"
            "write 0x1800:1 0x40000181  # COB-ID used by TPDO\n");
  spill("change.servoctl", console.out_text);
  ASSERT_EQ(run("run %change.servoctl"), 0) << console.err_text;
  EXPECT_EQ(run("diff node:1 node:2"), 0) << console.out_text;
}

TEST_F(BackupTest, OfADcfIsComparedWithAnotherByTheDictionariesOfBothWhicheverStandsFirst) {
  const auto dcf = [](const std::string& more) {
    return "[DeviceInfo]\nProductName=X\n[2001]\nParameterName=Gain\nObjectType=7\nDataType=6\nAccessType="
           "rw\n"
           "ParameterValue=5\n" +
           more;
  };
  spill("a.dcf", dcf(""));
  spill("b.dcf",
        dcf("[2002]\nParameterName=Extra\nObjectType=7\nDataType=6\nAccessType=rw\nParameterValue=7\n"));
  use("", "");
  for (const auto* line : {"diff %a.dcf %b.dcf --json", "diff %b.dcf %a.dcf --json"}) {
    EXPECT_EQ(run(line), 1) << console.err_text;
    EXPECT_NE(console.out_text.find(R"("compared":2,"different":1,)"), std::string::npos) << console.out_text;
    EXPECT_NE(console.out_text.find(R"("name":"Extra")"), std::string::npos) << console.out_text;
    EXPECT_EQ(console.out_text.find("fit "), std::string::npos) << console.out_text;
  }
}

TEST_F(BackupTest, WithAnEmptyTextShowsItAsOne) {
  spill("t.eds", "[2000]\nParameterName=Label\nObjectType=7\nDataType=9\nAccessType=rw\nDefaultValue=abc\n");
  use("sim:t@1", "t");
  ASSERT_EQ(run("write 0x2000 \"\""), 0) << console.err_text;
  EXPECT_EQ(run("diff factory node:1"), 1);
  EXPECT_NE(console.out_text.find("factory  node:1"), std::string::npos) << console.out_text;
  EXPECT_NE(console.out_text.find("abc      \"\""), std::string::npos) << console.out_text;
}

}  // namespace
}  // namespace servoctl::cli
