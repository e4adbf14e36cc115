// What comes from a file is held against the same rules as what is typed: COB-IDs, journals, lengths.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "backup_fixture.hpp"
#include "settings/backup_file.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class ForeignInput : public BackupTest {
 protected:
  std::string value(const std::string& object) {
    EXPECT_EQ(run("read " + object + " --json"), 0) << console.err_text;
    return console.out_text;
  }
  /// Runs a line that must be refused and change nothing.
  void refused(const std::string& line, const std::string& object, std::string_view why) {
    SCOPED_TRACE(line);
    const auto before = value(object);
    const int code = run(line);
    EXPECT_TRUE(code == 2 || code == 8) << code << console.out_text << console.err_text;
    EXPECT_NE(console.err_text.find(why), std::string::npos) << console.err_text;
    EXPECT_EQ(value(object), before);
  }
};

TEST_F(ForeignInput, PutsNoPdosIntoADriveThatPdoMapWouldRefuse) {
  for (const std::string_view family : {"gsd600", "dm", "ts", "da200", "cia402"}) {
    SCOPED_TRACE(family);
    use(fmt::format("sim:{}@1", family), std::string(family));
    const bool fixed = family == "gsd600" || family == "da200";
    spill("two.csv", "index,sub,raw\n0x1800,1,hex:A1 02 00 00\n0x1801,1,hex:A1 02 00 00\n");
    refused("restore %two.csv --yes", "0x1801:1", fixed ? "has the fixed COB-ID" : "of the same node");
    if (family == "cia402") continue;  // What it does not list is left to the drive.
    spill("absent.csv", "index,sub,raw\n0x1A01,0,hex:01\n0x1A01,1,hex:10 00 FF 5F\n");
    refused("restore %absent.csv --yes", "0x1A01:1", "0x5FFF");
  }
}

TEST_F(ForeignInput, NamesTheEntriesThatCannotBeUsedAndLeavesThemOutWhenItIsTold) {
  use("sim:gsd600@1", "gsd600");
  const auto entry = [](std::string_view section, std::string_view type, std::string_view value) {
    return fmt::format(
        "[{}]\nParameterName=x\nObjectType=0x7\nDataType={}\nAccessType=rw\nParameterValue={}\n", section,
        type, value);
  };
  // Pn0214 (1 to 65535) fits, Pn0049 (1 to 127, 0x2000:32) does not fit its limit, a word is no number, the
  // last is not an object of this drive.
  const auto good = entry("2001subF", "0x6", "450");
  const auto text = good + entry("60FE", "0x7", "many") + entry("5FFF", "0x6", "1");
  spill("t.dcf", text);
  EXPECT_EQ(run("restore %t.dcf --yes"), 7);
  EXPECT_NE(console.err_text.find("--skip-invalid leaves these 2 out"), std::string::npos)
      << console.err_text;
  EXPECT_NE(console.err_text.find("'many' is not a number"), std::string::npos) << console.err_text;
  EXPECT_NE(console.err_text.find("0x5FFF:0 is unknown to gsd600"), std::string::npos) << console.err_text;
  EXPECT_EQ(run("diff %t.dcf factory"), 7);
  EXPECT_EQ(run("diff %t.dcf factory --skip-invalid"), 1) << console.err_text;
  EXPECT_NE(console.out_text.find("450"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("restore %t.dcf --yes --skip-invalid"), 1) << console.err_text;
  EXPECT_NE(console.err_text.find("it is left out"), std::string::npos) << console.err_text;
  EXPECT_NE(value("0x2001:F").find("\"raw\":450"), std::string::npos);
  EXPECT_EQ(run("verify %t.dcf --skip-invalid"), 1) << console.err_text;

  const auto above = entry("2001subF", "0x6", "460") + entry("2000sub6", "0x6", "40000");
  spill("above.dcf", above);
  EXPECT_EQ(run("restore %above.dcf --yes"), 1);
  EXPECT_NE(console.err_text.find("--skip-invalid restores the rest"), std::string::npos) << console.err_text;
  EXPECT_NE(value("0x2001:F").find("\"raw\":450"), std::string::npos);
  EXPECT_EQ(run("restore %above.dcf --yes --skip-invalid"), 1) << console.err_text;
  EXPECT_NE(console.err_text.find("out of range"), std::string::npos) << console.err_text;
  EXPECT_NE(value("0x2001:F").find("\"raw\":460"), std::string::npos);
}

TEST_F(ForeignInput, PutsNoDcfOfAnotherMakersDriveIntoOne) {
  for (const std::string family : {"gsd600", "dm", "da200", "ts", "sv2"}) {
    SCOPED_TRACE(family);
    use("sim:" + family + "@1", family);
    const auto sheet = [](std::string_view info) {
      return fmt::format(
          "[DeviceInfo]\n{}[6083]\nParameterName=x\nObjectType=0x7\nDataType=0x7\nAccessType=rw\n"
          "ParameterValue=77\n",
          info);
    };
    spill("other.dcf", sheet("VendorNumber=0x123\nProductNumber=0x77\n"));
    EXPECT_EQ(run("restore %other.dcf --yes"), 8) << console.err_text;
    EXPECT_NE(console.err_text.find("is not the drive of"), std::string::npos) << console.err_text;
    spill("silent.dcf", sheet("VendorNumber=0\n"));
    EXPECT_EQ(run("restore %silent.dcf --yes --dry-run"), 0) << console.err_text;
    // What servoctl makes of the family's own data sheet goes back.
    EXPECT_EQ(run("backup %own.dcf --yes"), 0) << console.err_text;
    EXPECT_EQ(run("restore %own.dcf --yes"), 0) << console.err_text;
  }
}

struct CobId {
  std::uint32_t value;
  const char* why;
};
constexpr CobId kNone[] = {
    {0x000, "NMT"}, {0x080, "SYNC"}, {0x601, "SDO"}, {0x701, "error control"}, {0x07F, "a reserved service"}};

TEST_F(ForeignInput, PutsNoCobIdOfAnotherServiceIntoADrive) {
  for (const auto* family : {"gsd600", "dm", "cia402"}) {
    SCOPED_TRACE(family);
    use(fmt::format("sim:{}@1", family), family);
    for (const auto& [cob_id, why] : kNone) {
      SCOPED_TRACE(cob_id);
      const std::string hex = fmt::format("0x{:X}", cob_id);
      const auto raw = to_hex(store_le(cob_id, 4));
      refused("write 0x1801:1 " + hex, "0x1801:1", why);
      spill("id.bin", std::string({static_cast<char>(cob_id), static_cast<char>(cob_id >> 8U), '\0', '\0'}));
      refused("write 0x1801:1 --from %id.bin", "0x1801:1", why);
      refused("pdo map TPDO2 statusword --yes --cob-id " + hex, "0x1801:1", why);
      spill("t.csv", fmt::format("index,sub,raw\n0x1801,1,hex:{}\n", raw));
      refused("restore %t.csv --yes", "0x1801:1", why);
      spill("t.dcf",
            fmt::format("[1801sub1]\nParameterName=x\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\n"
                        "ParameterValue={}\n",
                        hex));
      refused("restore %t.dcf --yes", "0x1801:1", "");
      std::string concise("\1\0\0\0\1\x18\1\4\0\0\0", 11);
      concise += std::string({static_cast<char>(cob_id), static_cast<char>(cob_id >> 8U), '\0', '\0'});
      spill("t.bin", concise);
      refused("restore %t.bin --yes", "0x1801:1", why);
      spill("t.servoctl", "write 0x1801:1 " + hex + "\n");
      refused("run %t.servoctl", "0x1801:1", why);
      EXPECT_EQ(run("run --check %t.servoctl"), 2);
      spill("t.toml", fmt::format("format = 1\nfamily = \"{}\"\n[[pdo]]\npdo = \"TPDO2\"\ncob_id = \"{}\"\n"
                                  "valid = true\n",
                                  family, hex));
      refused("pdo apply %t.toml --yes", "0x1801:1", "");
    }
  }
}

TEST_F(ForeignInput, TakesTheRuleForSyncTimeEmcyAndStoredCopiesAsWell) {
  refused("write 0x1005 0x601", "0x1005", "belongs to SDO");
  refused("write 0x1014 0x000", "0x1014", "belongs to NMT");
  refused("param set Pn0118 0", "0x2000:77h", "out of range: 512");
  refused("param set Pn0121 0", "0x2000:7Ah", "a reserved service");
  refused("param set Pn0118 0x600", "0x2000:77h", "belongs to SDO");
  EXPECT_EQ(run("param set Pn0118 0x80000600"), 0) << "not valid, so not an assigned CAN-ID";
  use("sim:dm@1", "dm");
  refused("write 0x1012 0x80000701", "0x1012", "error control");
  EXPECT_EQ(run("write 0x1801:1 0x80000601"), 0) << console.err_text;
  EXPECT_EQ(run("write 0x1801:1 0x2A1"), 0) << console.err_text;
}

TEST_F(ForeignInput, AJournalIsWholeAndNamesNothingButTheMeansOfItsFamily) {
  const std::string body =
      R"("checksum":"c","node":1,"with_address":false,"force":false,"keep":false,"unlock":false,)";
  const std::vector<std::string> wrong = {
      "",
      "{}",
      "[]",
      std::string(40'000, '['),
      R"({"servoctl_journal":1,)" + body + R"("means":[]})",
      R"({"servoctl_journal":2,)" + body + R"("means":[]})",
      R"({"servoctl_journal":2,)" + body + R"("means":[],"seal":"fnv1a64:0000000000000000"})",
      R"({"servoctl_journal":2,)" + body +
          R"("means":[{"index":24640,"sub":0,"bytes":"0F 00"}],"seal":"fnv1a64:0000000000000000"})"};
  for (const auto* family : {"gsd600", "dm", "da200", "ts", "sv2", "cia402"}) {
    SCOPED_TRACE(family);
    use(fmt::format("sim:{}@1", family), family);
    ASSERT_EQ(run("backup %drive.json --yes"), 0);
    for (const auto& text : wrong) {
      SCOPED_TRACE(text.substr(0, 80));
      spill("drive.json.before-node-1.json.journal", text);
      for (const auto* how : {"restore %drive.json --yes --resume", "restore %drive.json --yes",
                              "restore %drive.json.before-node-1.json --yes"}) {
        const int code = run(how);
        EXPECT_TRUE(code == 7) << how << code << console.err_text;
      }
    }
    fs::remove(folder / "drive.json.before-node-1.json.journal");
  }
}

TEST_F(ForeignInput, TwoRestoresOfOneFileAndNodeDoNotRunAtOnce) {
  ASSERT_EQ(run("backup %drive.json"), 0);
  ASSERT_EQ(run("param set Pn0214=450"), 0);
  const auto lock = folder / "drive.json.before-node-1.json.journal.lock";
  const int other = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(::flock(other, LOCK_EX | LOCK_NB), 0);
  EXPECT_EQ(run("restore %drive.json --yes"), 8);
  EXPECT_NE(console.err_text.find("another servoctl is restoring"), std::string::npos) << console.err_text;
  EXPECT_EQ(run("restore %drive.json --dry-run"), 0) << "it writes nothing";
  EXPECT_FALSE(fs::exists(folder / "drive.json.before-node-1.json"));
  EXPECT_EQ(run("verify %drive.json"), 1) << "nothing was written";
  ::close(other);
  // One that was killed leaves its file behind, and holds nothing.
  EXPECT_EQ(run("restore %drive.json --yes"), 0) << console.err_text;
  EXPECT_FALSE(fs::exists(lock));
}

TEST_F(ForeignInput, TextOfEveryLengthIsPutBack) {
  fs::copy(fs::path(source_dir()) / "tests/cli/data/drives/lab", folder, fs::copy_options::recursive);
  for (const auto& file : fs::directory_iterator(fs::path(source_dir()) / "tests/cli/data/drives/lab"))
    fs::copy_file(file.path(), folder / file.path().filename(), fs::copy_options::overwrite_existing);
  use("sim:lab@1", "lab");
  for (const auto* text : {"\"\"", "\"a\"", "\"as long as it likes to be, and longer\"", "\"--from=x\""}) {
    SCOPED_TRACE(text);
    ASSERT_EQ(run(std::string("write 0x2000 -- ") + text), 0) << console.err_text;
    for (const auto* name : {"t.json", "t.csv", "t.servoctl"}) {
      SCOPED_TRACE(name);
      ASSERT_EQ(run(std::string("backup --yes %") + name), 0);
      ASSERT_EQ(run("write 0x2000 \"something else\""), 0);
      EXPECT_EQ(run(std::string("restore --yes %") + name), 0) << console.err_text;
      EXPECT_EQ(run(std::string("diff node:1 %") + name), 0) << console.out_text;
    }
    ASSERT_EQ(run("write 0x2000 \"something else\""), 0);
    EXPECT_EQ(run("run %t.servoctl --yes"), 0) << console.err_text;
    EXPECT_EQ(run("diff node:1 %t.json"), 0) << console.out_text;
  }
}

TEST_F(ForeignInput, WhatWasOutsideOfTheLimitsIsNamedAndKeepsNobodyFromTheRest) {
  use("sim:da200@1", "da200");
  ASSERT_EQ(run("backup %drive.json"), 0);
  ASSERT_EQ(run("backup %drive.csv"), 0);
  ASSERT_EQ(run("backup %drive.dcf"), 0);
  EXPECT_NE(console.err_text.find("outside of its limits 1..35"), std::string::npos) << console.err_text;
  ASSERT_EQ(run("backup %drive.servoctl"), 0);
  ASSERT_EQ(run("write 0x6098 35"), 0);
  ASSERT_EQ(run("param set P5.12 77"), 0);
  EXPECT_EQ(run("restore %drive.json --yes"), 1);
  EXPECT_NE(console.err_text.find("0 is out of range: 1..35"), std::string::npos) << console.err_text;
  EXPECT_NE(console.out_text.find("restored; 1 left as it is"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("diff %drive.json node:1"), 1);
  EXPECT_NE(console.out_text.find("0x6098"), std::string::npos);
  EXPECT_EQ(console.out_text.find("P5.12"), std::string::npos) << console.out_text;
  for (const auto* file :
       {"restore --yes %drive.csv", "restore --yes %drive.dcf", "restore --yes %drive.servoctl"}) {
    ASSERT_EQ(run("param set P5.12 77"), 0);
    EXPECT_EQ(run(file), 0) << file << console.err_text;
  }
  EXPECT_EQ(run("restore %drive.json --yes"), 1) << "told again, and nothing to be written";
  EXPECT_NE(console.out_text.find("nothing else differs; 1 left as it is"), std::string::npos)
      << console.out_text;
}

TEST_F(ForeignInput, DeepJsonIsRefusedByEveryCommandThatReadsIt) {
  for (const auto* open : {"[", "{\"a\":"}) {
    std::string deep;
    for (int i = 0; i < 10'000; ++i) deep += open;
    spill("deep.json", deep);
    for (const auto* line : {"restore %deep.json --yes", "verify %deep.json", "diff %deep.json node:1",
                             "pdo apply %deep.json --yes", "report %page.html --test %deep.json"}) {
      const int code = run(line);
      EXPECT_TRUE(code == 7 || code == 2) << line << " " << code << console.err_text;
    }
  }
}

TEST_F(ForeignInput, AFileIsKeptWhenItIsAskedFor) {
  for (const auto& file : fs::directory_iterator(eds / "vmmore")) fs::copy(file.path(), folder);
  spill("gain.bin", std::string("\xC2\x01", 2));
  EXPECT_EQ(run("write Pn0214 --from %gain.bin --keep"), 0) << console.err_text;
  EXPECT_NE(console.out_text.find("kept"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("param get Pn0214 --json"), 0);
  EXPECT_NE(console.out_text.find("\"raw\":450"), std::string::npos) << console.out_text;
  use("sim:sv2@1", "sv2");
  spill("sv2.bin", std::string("\x3C\x00", 2));
  EXPECT_EQ(run("write 2001h:1 --from %sv2.bin --keep"), 0) << console.err_text;
  // Its password is on the panel only: that is said, and nothing written.
  spill("other.bin", std::string("\x3D\x00", 2));
  EXPECT_EQ(run("write 2001h:1 --from %other.bin --keep --unlock"), 2);
  EXPECT_NE(console.err_text.find("no password over the bus"), std::string::npos);
  ASSERT_EQ(run("nmt reset --yes --wait"), 0);
  EXPECT_EQ(run("read 2001h:1 --json"), 0);
  EXPECT_NE(console.out_text.find("\"raw\":60"), std::string::npos)
      << "kept over the restart" << console.out_text;
}

}  // namespace
}  // namespace servoctl::cli
