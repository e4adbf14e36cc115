// Files of other tools, as a user puts them into a drive.
#include "backup_fixture.hpp"
#include "base/bytes.hpp"

namespace servoctl::cli {
namespace {

const std::string kForeign =
    "[DeviceComissioning]\nNodeID=0x01\n"
    "[1017]\nParameterName=Heartbeat\nObjectType=0x7\nDataType=0x0006\nAccessType=rw\nParameterValue=0x1F4\n";

TEST_F(BackupTest, OfAnotherToolWritesSettingsOnly) {
  spill("foreign.dcf",
        kForeign +
            "[6040]\nParameterName=Controlword\nDataType=0x0006\nAccessType=rww\nParameterValue=0xF\n"
            "[1000]\nParameterName=Type\nDataType=0x0007\nAccessType=ro\nParameterValue=1\n"
            "[605A]\nParameterName=Stop\nDataType=0x0004\nAccessType=rw\nParameterValue=5\n"
            "[1400]\nParameterName=R\nObjectType=9\nSubNumber=2\n"
            "[1400sub0]\nParameterName=n\nDataType=5\nAccessType=ro\n"
            "[1400sub1]\nParameterName=id\nDataType=7\nAccessType=rw\nParameterValue=$NODEID+0x200\n");
  ASSERT_EQ(run("restore %foreign.dcf --yes"), 0) << console.err_text;
  EXPECT_NE(
      console.err_text.find(
          "not settings, left out: 0x1000:0 Device type (read-only), 0x6040:0 Controlword (process data)"),
      std::string::npos)
      << console.err_text;
  EXPECT_NE(console.out_text.find("different  2"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("verify %foreign.dcf"), 0) << console.out_text;
  EXPECT_EQ(run("read 605Ah 1017h --json"), 0);
  EXPECT_NE(console.out_text.find("\"raw\":5,"), std::string::npos) << console.out_text;
  EXPECT_NE(console.out_text.find("\"raw\":500,"), std::string::npos) << console.out_text;
}

// Pn0116 is what the drive takes 1017h from at its start (its `mirror` in the data of the family).
TEST_F(BackupTest, OfAnotherToolIsKeptWhereTheDriveTakesItFromAtItsStart) {
  spill("foreign.dcf", kForeign);
  ASSERT_EQ(run("restore %foreign.dcf --keep --yes"), 0) << console.err_text;
  EXPECT_NE(console.out_text.find("Pn0116"), std::string::npos) << console.out_text;
  ASSERT_EQ(run("nmt reset --wait --yes"), 0) << console.err_text;
  EXPECT_EQ(run("verify %foreign.dcf"), 0) << console.out_text;
  // What the file says of the parameter itself stays.
  spill("both.csv", "index,sub,type,value\n0x1017,0,u16,700\n0x2000,0x75,u16,300\n");
  ASSERT_EQ(run("restore %both.csv --keep --yes"), 0) << console.err_text;
  EXPECT_EQ(run("verify %both.csv"), 0) << console.out_text;
}

std::string entry(std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::size_t size) {
  Bytes out = store_le(index, 2);
  out.push_back(sub);
  for (const auto byte : store_le(size, 4)) out.push_back(byte);
  for (const auto byte : store_le(value, size)) out.push_back(byte);
  return {out.begin(), out.end()};
}

std::string concise(const std::string& entries, std::uint32_t count) {
  const auto head = store_le(count, 4);
  return std::string(head.begin(), head.end()) + entries;
}

TEST_F(BackupTest, OfAConciseDcfIsRestored) {
  const auto one = entry(0x1017, 0, 500, 2);
  const auto procedure =
      entry(0x1800, 1, 0xC0000181, 4) + entry(0x1800, 2, 1, 1) + entry(0x1800, 1, 0x40000181, 4);
  spill("good.cdc", concise(one + procedure, 4));
  ASSERT_EQ(run("restore %good.cdc --yes"), 0) << console.err_text;
  EXPECT_NE(console.err_text.find("is a concise DCF"), std::string::npos);
  EXPECT_EQ(run("verify %good.cdc"), 0) << console.out_text;
  EXPECT_NE(console.out_text.find("compared     3"), std::string::npos) << console.out_text;
  const std::pair<std::string, const char*> wrong[] = {
      {concise(one + procedure, 5), "bad.cdc:5: the file ends within this entry, of 5"},
      {concise(one + procedure, 3), "11 bytes follow the last of 3 entries"},
      {concise(one.substr(0, one.size() - 1), 1), "bad.cdc:1: the file ends within this entry, of 1"},
      {concise("", 0), "there is no entry in it"},
      {concise(one + one, 2), "bad.cdc:2: 0x1017:0 appears again, first in 1"},
      {concise(entry(0x100C, 0, 500, 2) + entry(0x605A, 0, 500, 4), 2), "bad.cdc:2: 0x605A:0"},
      {concise(entry(0x5FFF, 0, 0, 4), 1), "bad.cdc:1: 0x5FFF:0 is unknown to gsd600"}};
  for (const auto& [bytes, said] : wrong) {
    spill("bad.cdc", bytes);
    EXPECT_EQ(run("restore %bad.cdc --yes"), 7) << said;
    EXPECT_NE(console.err_text.find(said), std::string::npos) << console.err_text;
  }
}

TEST_F(BackupTest, OfLinesOfAnotherMasterIsRestored) {
  spill("lines.txt",
        "# of a CiA 309-3 gateway\n[1] 1 1 w 0x1017 0 u16 500\n1 w 0x2001 15 u16 450\n"
        "write statusword_is_no_setting 1\n");
  EXPECT_EQ(run("restore %lines.txt --yes"), 7);
  EXPECT_NE(console.err_text.find("lines.txt:4: "), std::string::npos) << console.err_text;
  spill("lines.txt", "[1] 1 1 w 0x1017 0 u16 500\nset GAIN=45Hz\nparam set Pn0214=${GAIN}\n");
  ASSERT_EQ(run("restore %lines.txt --yes"), 0) << console.err_text;
  EXPECT_NE(console.out_text.find("different  2"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("verify %lines.txt"), 0);
}

TEST_F(BackupTest, AsATableIsEditedInASpreadsheet) {
  ASSERT_EQ(run("backup %gain.csv --only gain"), 0);
  const auto good = slurp("gain.csv");
  const auto place = good.find("Speed loop gain 1,u16,60,Hz,hex:58 02");
  ASSERT_NE(place, std::string::npos) << good;
  const auto with = [&](std::string_view cells) {
    return replaced(good, "Speed loop gain 1,u16,60,Hz,hex:58 02", cells);
  };
  spill("edited.csv", with("Speed loop gain 1,u16,45,Hz,hex:58 02"));
  EXPECT_EQ(run("restore %edited.csv --yes"), 7);
  EXPECT_NE(console.err_text.find("value 45 Hz and raw hex:58 02 (60) differ"), std::string::npos)
      << console.err_text;
  spill("edited.csv", with("Speed loop gain 1,u16,45.0,Hz,"));
  ASSERT_EQ(run("restore %edited.csv --yes"), 0) << console.err_text;
  EXPECT_NE(console.out_text.find("450 = 45 Hz"), std::string::npos) << console.out_text;
  spill("edited.csv", with("Speed loop gain 1,u16,60.00,Hz,58 02"));
  EXPECT_EQ(run("restore %edited.csv --yes"), 0) << console.err_text;
  EXPECT_EQ(run("verify %gain.csv"), 0) << console.out_text;
}

TEST_F(BackupTest, AsATableMayComeInTheEncodingsOfSpreadsheets) {
  const std::string table = "index,sub,value,unit\r\n0x2001,0x0F,45,Hz\r\n";
  std::string wide = "\xFF\xFE";
  for (const char c : table) wide += std::string{c, '\0'};
  for (const auto& text : {table, "\xEF\xBB\xBF" + table, wide}) {
    spill("sheet.csv", text);
    EXPECT_EQ(run("verify %sheet.csv"), 1) << console.err_text;
    EXPECT_NE(console.out_text.find("450 = 45 Hz"), std::string::npos) << console.out_text;
  }
}

TEST_F(BackupTest, ATableKeepsTextsFromBeingRunAndBringsThemBack) {
  std::filesystem::copy(std::filesystem::path(source_dir()) / "tests/cli/data/drives/lab", folder / "lab",
                        std::filesystem::copy_options::recursive);
  for (const auto* text : {"=1+1", "@abc", "+a-b", "'=1'", "-123"}) {
    SCOPED_TRACE(text);
    use("sim:lab@1", "lab");
    ASSERT_EQ(run(fmt::format("write 2000 \"{}\"", text)), 0) << console.err_text;
    ASSERT_EQ(run("backup %text.csv --yes"), 0) << console.err_text;
    const bool number = std::string_view(text) == "-123";
    EXPECT_NE(slurp("text.csv").find(fmt::format(",{}{},", number ? "" : "'", text)), std::string::npos)
        << slurp("text.csv");
    ASSERT_EQ(run("write 2000 none"), 0) << console.err_text;
    EXPECT_EQ(run("verify %text.csv"), 1);
    ASSERT_EQ(run("restore %text.csv --yes"), 0) << console.err_text;
    ASSERT_EQ(run("read 2000 --json"), 0);
    EXPECT_NE(console.out_text.find(fmt::format("\"{}\"", text)), std::string::npos) << console.out_text;
  }
}

TEST_F(BackupTest, InAFormatWithoutChecksumIsRefusedByLineAndEntry) {
  ASSERT_EQ(run("backup %all.json"), 0);
  const std::string head = "index,sub,value\n";
  struct Case {
    const char* file;
    std::string text;
    const char* said;
  };
  const Case cases[] = {
      {"x.csv", head + "0x5FFF,0,1\n", "x.csv:2: 0x5FFF:0 is unknown to gsd600"},
      {"x.csv", head + "0x100C,0,500\n0x100C,0,600\n", "x.csv:3: 0x100C:0 appears again, first in 2"},
      {"x.csv", head + "0x100C,0,70000\n", "x.csv:2: value: 70000 does not fit u16"},
      {"x.csv", head + "0x2000,0x32,128\n", "x.csv:2: value: 128 is out of range: 1..127"},
      {"x.csv", head + "heartbeat,0,1\n", "x.csv:2: 'heartbeat:0' is not an index and sub-index"},
      {"x.csv", "index,sub,raw\n0x100C,0,hex:01\n", "x.csv:2: 0x100C:0 (Guard time): has 1 bytes"},
      {"x.csv", "index,sub,raw\n0x1017,0,hex:1\n", "x.csv:2: raw: 'hex:1' is not hexadecimal bytes"},
      {"x.csv", "node,index,value\n1,0x100C,1\n2,0x1005,1\n", "x.csv:3: is of node 2, the rows before"},
      {"x.csv", "node,index,value\n128,0x1017,1\n", "x.csv:2: '128' is not a node-ID"},
      {"x.csv", "index,sub\n0x1017,0\n", "has the columns index and raw or value"},
      {"x.csv", head + "0x1017,0\n", "x.csv:2:"},
      {"x.dcf", replaced(kForeign, "0x1F4", "0x1F400"), "x.dcf:8: ParameterValue: 0x1F400 does not fit u16"},
      {"x.dcf", replaced(kForeign, "[1017]", "[5FFF]"), "x.dcf:8: 0x5FFF:0 is unknown to gsd600"},
      {"x.dcf", slurp("all.json").substr(0, 300), "not JSON"},
      {"x.txt", "param set Pn0214=450\nparam set Pn214=451\n",
       "x.txt:2: 0x2001:0Fh appears again, first in 1"},
      {"x.txt", "param set Pn0214=999999\n", "x.txt:1: Pn0214 Speed loop gain 1: 999999"},
      {"x.txt", "param set Pn9999=1\n", "x.txt:1: "},
      {"x.txt", "write 0x100C 5\nstore\n", "x.txt:2: 'store' writes no value"},
      {"x.txt", "write 0x100C 5\npause \"now\"\n", "x.txt:2: 'pause now' writes no value"},
      {"x.txt", "use 1\nwrite 0x100C 5\nuse 2\nwrite 0x1005 5\n", "x.txt:4: is for another node"},
      {"x.txt", "drive dm\nwrite 0x1017 5\n", "x.txt:2: is for dm, not for gsd600"},
      {"x.txt", "hello world\n", "x.txt:1: "},
      {"x.txt", "# nothing\n", "not JSON"},
      {"x.txt", "drive gsd600\n", "no line in it writes a value"},
  };
  for (const auto& c : cases) {
    spill(c.file, c.text);
    EXPECT_EQ(run(fmt::format("restore %{} --yes", c.file)), 7) << c.said << console.out_text;
    EXPECT_NE(console.err_text.find(c.said), std::string::npos) << c.said << "\n" << console.err_text;
    EXPECT_EQ(run("verify %all.json"), 0) << "nothing is written unless everything can be";
  }
}

}  // namespace
}  // namespace servoctl::cli
