// The dictionaries of the simulated drives, learned from the wire alone.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "drive/profile.hpp"
#include "od/eds.hpp"
#include "sample_lines.hpp"

namespace servoctl::cli {
namespace {

class LearnedFamily : public testing::TestWithParam<const char*> {};

/// Error histories are empty, and one object of gsd600 refuses to be read.
bool is_visible(const od::Entry& entry) {
  return (entry.address.index != 0x1003 || entry.address.sub == 0) &&
         entry.address != ObjectAddress{0x2005, 0x21};
}

/// Where each request for what is not there is an alarm, a scan of everything takes minutes.
bool is_in_short_range(std::uint16_t index) {
  return (index >= 0x1000 && index <= 0x1020) || (index >= 0x6040 && index <= 0x6070);
}

TEST_P(LearnedFamily, IsThatOfItsData) {
  const std::string family = GetParam();
  SampleLines lines(family);
  const std::string despite = family == "da200" ? " --despite-alarms --range 1000-1020,6040-6070 -y" : "";
  lines.console.out_text.clear();
  ASSERT_EQ(lines.perform("eds learn -o DIR/learned.eds -n 1" + despite, {}, false), 0)
      << lines.console.err_text;
  std::ostringstream text;
  text << std::ifstream(lines.folder() / "learned.eds").rdbuf();
  const auto sheet = od::read_eds(text.str(), "learned.eds");
  ASSERT_TRUE(sheet);
  EXPECT_EQ(sheet->error_count() + sheet->warning_count(), 0U);
  const fs::path folders[] = {fs::path(source_dir()) / "eds"};
  const auto profile = drive::load_profile(family, folders).value();
  std::size_t visible = 0;
  for (const auto& object : profile.dictionary.objects())
    for (const auto& entry : object.entries) {
      if (!is_visible(entry)) continue;
      if (!despite.empty() && !is_in_short_range(entry.address.index)) continue;
      ++visible;
      const auto* found = sheet->dictionary.find(entry.address);
      ASSERT_NE(found, nullptr) << to_string(entry.address);
      EXPECT_EQ(od::readable(found->access), od::readable(entry.access)) << to_string(entry.address);
      const auto size = od::size_of(entry.type);
      if (size && od::readable(entry.access)) {
        EXPECT_EQ(od::size_of(found->type), size) << to_string(entry.address);
      }
    }
  EXPECT_EQ(sheet->dictionary.entry_count(), visible) << "and nothing else";
  EXPECT_EQ(sheet->dictionary.find({0x1000, 0})->name, "Device type") << "as the standard names it";
  EXPECT_EQ(sheet->dictionary.find({0x6040, 0})->access, od::Access::rw);
}

INSTANTIATE_TEST_SUITE_P(Families, LearnedFamily,
                         testing::Values("cia402", "da200", "dm", "gsd600", "sv2", "ts"));

TEST(LearnRefusal, ADriveThatRaisesAlarmsIsNotScannedUnasked) {
  SampleLines lines("da200");
  EXPECT_EQ(lines.perform("eds learn -o DIR/learned.eds -n 1", {}, false), 8);
  EXPECT_FALSE(fs::exists(lines.folder() / "learned.eds"));
  EXPECT_EQ(lines.perform("eds learn -o DIR/learned.eds --despite-alarms -n 1", {}, false), 8)
      << "not confirmed";
}

/// Text of a file in the folder of the lines.
std::string content_of(const SampleLines& lines, const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(lines.folder() / name).rdbuf();
  return text.str();
}

TEST(LearnedBackup, HasTheValuesOfTheMakerAndRestoreWritesNoneUntilTheFileSaysSo) {
  SampleLines lines("gsd600");
  ASSERT_EQ(
      lines.perform("eds learn -o DIR/learned.eds --range 1000-1018,2000-2010,6040-60FF -n 1", {}, false), 0);
  ASSERT_EQ(lines.perform("backup DIR/learned.json -n 1 -d DIR/learned.eds", {}, false), 0)
      << lines.console.err_text;
  EXPECT_NE(content_of(lines, "learned.json").find("\"index\":8192,"), std::string::npos);
  EXPECT_EQ(lines.perform("verify DIR/learned.json -n 1 -d DIR/learned.eds", {}, false), 0)
      << lines.console.err_text;
  ASSERT_EQ(lines.perform("restore DIR/learned.json -n 1 -d DIR/learned.eds -y", {}, false), 0)
      << lines.console.err_text;
  ASSERT_EQ(lines.perform("backup DIR/learned.servoctl -n 1 -d DIR/learned.eds", {}, false), 0)
      << lines.console.err_text;
  const auto text = content_of(lines, "learned.servoctl");
  EXPECT_NE(text.find("\n# not known to be writable: write 0x2000:"), std::string::npos) << text;
  EXPECT_EQ(text.find("\nwrite 0x2000:"), std::string::npos) << "it would be refused";
  EXPECT_EQ(lines.perform("write 0x2000:1 8 -n 1 -d DIR/learned.eds -y", {}, false), 2);
  EXPECT_NE(lines.console.err_text.find("change its AccessType"), std::string::npos)
      << lines.console.err_text;
}

/// Lines on one bus, after the drive was learned.
class LearnedFile : public testing::Test {
 protected:
  LearnedFile() {
    ::setenv("XDG_CONFIG_HOME", lines.folder().c_str(), 1);
    fs::current_path(lines.folder());  // A clone keeps the old values there.
    EXPECT_EQ(lines.perform("eds learn -o DIR/a.eds -n 1", {}, false), 0) << lines.console.err_text;
  }
  ~LearnedFile() override {
    fs::current_path(before);
    ::unsetenv("XDG_CONFIG_HOME");
  }
  /// The exit code; the first line that fails is the last.
  int run(std::string text) {
    const std::string name = "DIR";
    for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at))
      text.replace(at, name.size(), lines.folder().string());
    std::ofstream(lines.folder() / "lines.servoctl") << text;
    lines.console.out_text.clear();
    return lines.perform("run DIR/lines.servoctl", {}, false);
  }
  bool says(const std::string& text) { return all().find(text) != std::string::npos; }
  std::string all() { return lines.console.out_text + lines.console.err_text; }

  fs::path before = fs::current_path();
  SampleLines lines{"gsd600"};
};

TEST_F(LearnedFile, ARestoreComparesWhatItDoesNotWrite) {
  EXPECT_EQ(run("backup DIR/bk.json -n 1 -d DIR/a.eds\nrestore DIR/bk.json -n 1 -d DIR/a.eds -y\n"), 0)
      << all();
  EXPECT_TRUE(says("nothing differs")) << all();
  EXPECT_EQ(run("param set Pn0214=77 -n 1 -d gsd600 -y\n"
                "restore DIR/bk.json -n 1 -d DIR/a.eds -y --json\n"),
            1)
      << all();
  EXPECT_TRUE(says(R"("result":"nothing else differs; 1 left as it is")")) << all();
  EXPECT_TRUE(says(R"("compared":468,"different":1)")) << all();
  EXPECT_EQ(run("param set Pn0214=77 -n 1 -d gsd600 -y\nwrite 0x6083 4321 -n 1 -d gsd600 -y\n"
                "restore DIR/bk.json -n 1 -d DIR/a.eds -y\n"),
            1)
      << all();
  EXPECT_TRUE(says("restored; 1 left as it is")) << all();
  EXPECT_TRUE(says("0x2001:0Fh differs from") && says("change AccessType to rw in")) << all();
}

TEST_F(LearnedFile, AFamilyMadeOfItKnowsAsMuch) {
  ASSERT_EQ(run("backup DIR/bk.json -n 1 -d DIR/a.eds\ndrives new q1 --from DIR/a.eds\n"), 0) << all();
  EXPECT_TRUE(says("access of the maker's objects")) << all();
  ASSERT_EQ(run("backup DIR/q1.json -n 1 -d DIR/servoctl/drives/q1/q1.toml\n"), 0) << all();
  const auto count = [](const std::string& text) {
    std::size_t out = 0;
    for (auto at = text.find("\"bytes\":\""); at != std::string::npos; at = text.find("\"bytes\":\"", at + 1))
      ++out;
    return out;
  };
  EXPECT_GT(count(content_of(lines, "bk.json")), 400U);
  EXPECT_EQ(count(content_of(lines, "q1.json")), count(content_of(lines, "bk.json")));
  EXPECT_NE(run("write 0x2001:0F 8 -n 1 -d DIR/servoctl/drives/q1/q1.toml -y\n"), 0);
  EXPECT_TRUE(says("is not known to be writable")) << all();
}

/// 2000h:32h is the node-ID, which a learned file does not know.
TEST_F(LearnedFile, IsMeantForEachNode) {
  EXPECT_EQ(run("write 0x6083 4321 -n 1 -d gsd600 -y\nclone --from 1 --to 2 -d DIR/a.eds -y\n"), 1) << all();
  EXPECT_TRUE(says("restored; 1 left as it is")) << all();
  EXPECT_TRUE(says("0x2000:32h differs from node 1 and is left as it is")) << all();
  EXPECT_EQ(run("clone --from 1 --to 2 -d DIR/a.eds -y --json\n"), 1) << all();
  EXPECT_TRUE(says(R"("different":1,"differences":[{"index":8192,"sub":50,)")) << all();
  EXPECT_FALSE(says("1014")) << "it follows the node-ID: " << all();
}

TEST_F(LearnedFile, WhatACloneRefusesHasNoLine) {
  auto text = content_of(lines, "a.eds");
  const std::string follows = "$NODEID+0x80\n";
  ASSERT_NE(text.find(follows), std::string::npos);
  text.replace(text.find(follows), follows.size(), "0x81\n");
  std::ofstream(lines.folder() / "a.eds") << text;
  EXPECT_EQ(run("clone --from 1 --to 2 -d DIR/a.eds -y\n"), 8);
  EXPECT_TRUE(says("node 1: 0x1014:0 ")) << all();
  EXPECT_FALSE(says("node 1:0:")) << all();
}

TEST_F(LearnedFile, ACabinetFileLeavesOutWhatNobodyKnowsToBeWritable) {
  ASSERT_EQ(run("cabinet init DIR/made.toml -d DIR/a.eds -n 1\n"), 0) << all();
  EXPECT_TRUE(says("node 1: 459 settings are not compared")) << all();
}

/// The entry that is said to be `ro` is as one of a PDO that no standard has.
TEST_F(LearnedFile, ACabinetSaysWhatItCannotWrite) {
  auto sheet = content_of(lines, "a.eds");
  const auto entry = sheet.find("AccessType=rw", sheet.find("[1601sub2]"));
  ASSERT_NE(entry, std::string::npos);
  sheet.replace(entry, 13, "AccessType=ro");
  std::ofstream(lines.folder() / "a.eds") << sheet;
  std::ofstream(lines.folder() / "c.toml")
      << "format = 1\n[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.feeder]\nbus = \"main\"\nnode = 1\n"
         "family = \"a.eds\"\npdos = [{pdo = \"RPDO2\", map = [\"0x6040\", \"0x607A\"]}]\n";
  const std::string left = "feeder: 0x1601:2 differs from ";
  EXPECT_EQ(run("cabinet plan --cabinet DIR/c.toml\n"), 1) << all();
  EXPECT_TRUE(says(left) && says("0x607A0020")) << all();
  for (const auto* how : {" -y", " -y --all-or-nothing", " --dry-run"}) {
    EXPECT_EQ(run(std::string("cabinet apply --cabinet DIR/c.toml --json") + how + "\n"), 1) << all();
    EXPECT_TRUE(says(left) && says("left as it is")) << how << all();
    EXPECT_FALSE(says(R"("result":"applied")") || says(R"("message":"")")) << how << all();
  }
}

}  // namespace
}  // namespace servoctl::cli
