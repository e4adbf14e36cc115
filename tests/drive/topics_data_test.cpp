// Every file of topics in eds/ is read, stays within the manual and the screen, and names objects that exist.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <set>

#include "base/file.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "drive/topic_scope.hpp"
#include "drive/topics.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

namespace fs = std::filesystem;

/// How many lines the manual of the family has; 0 where it does not lie beside the project.
std::size_t manual_lines(const std::string& family) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::path(source_dir()) / "../shared/seeds", error)) {
    if (!entry.path().filename().string().starts_with(family + "-")) continue;
    const auto text = read_file(entry.path());
    return text ? static_cast<std::size_t>(std::count(text->begin(), text->end(), '\n')) : 0;
  }
  return 0;
}

/// The last line that is named; 0 of a clause.
std::size_t last_line(const std::string& line) {
  std::size_t out = 0;
  for (const auto part : split(std::string_view(line), ' ')) {
    const auto last =
        parse_digits(part.substr(part.find('-') == std::string_view::npos ? 0 : part.find('-') + 1), 10);
    out = std::max(out, static_cast<std::size_t>(last.value_or(0)));
  }
  return out;
}

class TopicData : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto loaded = load_profile(GetParam(), kFolders);
    ASSERT_TRUE(loaded) << loaded.error().message.text();
    profile = std::move(*loaded);
    auto read = load_own_topics(profile);
    ASSERT_TRUE(read) << read.error().message.text();
    topics = std::move(*read);
    EXPECT_TRUE(load_topics(profile, kFolders));
  }
  Profile profile;
  std::vector<Topic> topics;
};

TEST_P(TopicData, FitsTheScreen) {
  constexpr std::size_t kTitle = 70;
  constexpr std::size_t kPictureWidth = 76;
  constexpr std::size_t kPictureLines = 16;
  for (const auto& topic : topics) {
    EXPECT_LE(display_width(topic.title), kTitle) << topic.name;
    EXPECT_LE(display_width(topic.title_zh), kTitle) << topic.name;
    EXPECT_EQ((topic.title + topic.title_zh + topic.name).find('\n'), std::string::npos) << topic.name;
    const auto lines = split(std::string_view(topic.picture), '\n');
    EXPECT_LE(lines.size(), kPictureLines + 1) << topic.name;
    for (const auto line : lines) {
      EXPECT_LE(line.size(), kPictureWidth) << topic.name << ": " << line;
      EXPECT_TRUE(std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; }))
          << topic.name << ": " << line;
    }
  }
}

TEST_P(TopicData, StandsWithinTheManual) {
  const auto lines = manual_lines(GetParam());
  if (lines == 0) return;
  for (const auto& topic : topics) {
    EXPECT_LE(last_line(topic.line), lines + 1) << topic.name;
    for (const auto& row : topic.rows)
      EXPECT_LE(last_line(row.line), lines + 1) << topic.name << ": " << row.cells.front();
  }
}

TEST_P(TopicData, NamesObjectsAndValuesThatTheDictionaryHas) {
  for (const auto& topic : topics) {
    if (!topic.object) continue;
    const auto target = target_at(&profile, *topic.object);
    ASSERT_NE(target.entry, nullptr) << topic.name << ": " << to_string(*topic.object);
    if (!topic.value) continue;
    const auto value = od::parse_value(target.entry->type, std::to_string(*topic.value));
    ASSERT_TRUE(value) << topic.name;
    EXPECT_TRUE(check_limits(meaning(target, 1), *value)) << topic.name << ": " << *topic.value;
  }
}

/// Of a drive the standard explains what it has, and nothing else.
TEST(TopicScope, LeavesOutWhatTheFamilyDoesNotHave) {
  // A topic of the family's own takes the place of the standard's.
  const auto names_for = [](const char* family, bool own_too) {
    const auto profile = load_profile(family, kFolders).value();
    const auto topics = load_topics(profile, kFolders).value();
    std::set<std::string> out;
    for (const auto& topic : topics)
      if (own_too || topic.family == kStandardFamily) out.insert(topic.name);
    return out;
  };
  const auto lacks = [&](const char* family, std::initializer_list<const char*> names) {
    const auto known = names_for(family, false);
    for (const auto* name : names) EXPECT_FALSE(known.contains(name)) << family << ": " << name;
  };
  const auto has = [&](const char* family, std::initializer_list<const char*> names) {
    const auto known = names_for(family, true);
    for (const auto* name : names) EXPECT_TRUE(known.contains(name)) << family << ": " << name;
  };
  lacks("gsd600", {"AL states", "OP", "EtherCAT RUN LED", "csp", "statusword csp", "quick stop option code",
                   "homing method 37"});
  has("gsd600", {"heartbeat", "termination", "statusword ip", "home offset"});
  lacks("sv2", {"heartbeat", "termination", "NMT states", "COB-ID", "homing method 5", "statusword ip"});
  has("sv2", {"AL states", "statusword csp", "EMCY"});
  lacks("ts", {"AL states", "homing method 33", "ip"});
  lacks("dm", {"quick stop option code", "statusword csp", "modes of operation"});
  has("cia402", {"heartbeat", "AL states", "homing method 5", "statusword csp", "quick stop option code"});
}

TEST(TopicScope, ListsOnlyTheHomingMethodsOfTheFamily) {
  const auto profile = load_profile("sv2", kFolders).value();
  const auto topics = load_topics(profile, kFolders).value();
  for (const auto& topic : topics) {
    if (topic.name != "homing methods" || topic.family != kStandardFamily) continue;
    std::vector<std::string> methods;
    for (const auto& row : topic.rows) methods.push_back(row.cells.front());
    EXPECT_FALSE(methods.empty());
    EXPECT_EQ(std::count(methods.begin(), methods.end(), "5"), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(TopicFamilies, TopicData,
                         testing::Values("cia402", "da200", "dm", "gsd600", "sv2", "ts"));

}  // namespace
}  // namespace servoctl::drive
