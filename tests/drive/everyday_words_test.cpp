#include "drive/everyday_words.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "base/text.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

namespace fs = std::filesystem;

std::string refused_words(std::string_view csv) {
  const auto words = parse_everyday_words(csv, "f.words.csv");
  return words ? "-" : words.error().message.text();
}

TEST(EverydayWords, ReadsThingsAndWhatTheyAreCalled) {
  const auto words = parse_everyday_words("thing,words,manual\njog,jog; inching;点动,\nnotch,,none\n", "f");
  ASSERT_TRUE(words) << words.error().message.text();
  EXPECT_EQ(*words,
            (std::vector<EverydayWords>{{"jog", {"jog", "inching", "点动"}, false}, {"notch", {}, true}}));
}

TEST(EverydayWords, TellsTheLineOfAMistake) {
  EXPECT_EQ(refused_words("thing,words\n"), "f.words.csv:1: the columns are not thing,words,manual");
  EXPECT_EQ(refused_words("thing,words,manual\n,jog,\n"), "f.words.csv:2: 'thing' is missing");
  EXPECT_EQ(refused_words("thing,words,manual\njog,a,\njog,b,\n"), "f.words.csv:3: 'jog' appears twice");
  EXPECT_EQ(refused_words("thing,words,manual\njog,a,no\n"), "f.words.csv:2: 'manual' is none, or empty");
}

struct ManualOfFamily {
  const char* family;
  const char* file;
};
constexpr ManualOfFamily kManualFiles[] = {{"gsd600", "gsd600-canopen-manual.txt"},
                                           {"dm", "dm-canopen-manual.txt"},
                                           {"da200", "da200-canopen-guide.txt"},
                                           {"ts", "ts-modbus-canopen-manual.txt"},
                                           {"sv2", "sv2-ethercat-manual.txt"}};

/// Without blanks, line breaks and the tags of tables; in lower case.
std::string bare_text(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto end = text[i] == '<' ? text.find('>', i) : std::string_view::npos;
    if (end != std::string_view::npos && end - i < 12)
      i = end;
    else if (std::string_view(" \t\r\n").find(text[i]) == std::string_view::npos)
      out += text[i];
  }
  return lower(out);
}

TEST(EverydayWords, OfAFamilyNameThingsThatTheStandardFileNames) {
  const std::vector folders{fs::path(source_dir()) / "eds"};
  const auto standard = load_profile("cia402", folders);
  ASSERT_TRUE(standard);
  const auto common = load_everyday_words(*standard, folders);
  ASSERT_TRUE(common) << common.error().message.text();
  std::set<std::string> names;
  for (const auto& thing : *common) names.insert(thing.name);
  EXPECT_GT(names.size(), 30U);
  for (const auto& manual : kManualFiles) {
    const auto profile = load_profile(manual.family, folders);
    ASSERT_TRUE(profile) << manual.family;
    const auto words = load_everyday_words(*profile, folders);
    ASSERT_TRUE(words) << words.error().message.text();
    for (const auto& thing : *words) EXPECT_TRUE(names.contains(thing.name)) << manual.family << thing.name;
  }
}

/// "The manual has nothing about it" is a statement about the manual.
TEST(EverydayWords, ThatAManualLacksStandNowhereInIt) {
  fs::path manuals;
  for (const auto* place : {"../shared/seeds", "../../shared/seeds"})
    if (fs::exists(fs::path(source_dir()) / place)) manuals = fs::path(source_dir()) / place;
  if (manuals.empty()) GTEST_SKIP() << "the manuals do not lie beside the project";
  const std::vector folders{fs::path(source_dir()) / "eds"};
  for (const auto& manual : kManualFiles) {
    const auto profile = load_profile(manual.family, folders);
    ASSERT_TRUE(profile) << manual.family;
    const auto words = load_everyday_words(*profile, folders);
    ASSERT_TRUE(words) << words.error().message.text();
    std::ostringstream content;
    content << std::ifstream(manuals / manual.file).rdbuf();
    const auto text = bare_text(content.str());
    ASSERT_GT(text.size(), 1000U) << manual.file;
    for (const auto& thing : *words) {
      if (!thing.absent) continue;
      for (const auto& word : thing.words)
        EXPECT_EQ(text.find(bare_text(word)), std::string::npos)
            << manual.family << " has something about " << thing.name << ": " << word;
    }
  }
}

}  // namespace
}  // namespace servoctl::drive
