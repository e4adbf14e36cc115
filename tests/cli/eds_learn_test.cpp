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
  EXPECT_NE(lines.console.err_text.find("could not see whether they can be written"), std::string::npos)
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

}  // namespace
}  // namespace servoctl::cli
