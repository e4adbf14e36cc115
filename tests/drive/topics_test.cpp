#include "drive/topics.hpp"

#include <gtest/gtest.h>

#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

const std::filesystem::path kTopicFolders[] = {std::filesystem::path(source_dir()) /
                                               "tests/cli/data/explain"};

const std::string kHead = "format = 1\n[[topic]]\n";
const std::string kWhole =
    kHead + "kind = \"led\"\nname = \"RUN\"\ntitle = \"LED RUN\"\ntitle_zh = \"指示灯 RUN\"\nline = \"12\"\n";
const std::string kTexts = "text = \"Green.\"\ntext_zh = \"绿色。\"\n";

std::string refusal(const std::string& toml) {
  const auto topics = parse_topics(toml, "f.topics.toml", "f");
  return topics ? "none" : topics.error().message.text();
}

TEST(Topics, AreReadWithAllTheirKeys) {
  const auto topics = parse_topics(
      kWhole + kTexts +
          "also = [\"run light\"]\ncolumns = [\"pattern\"]\ncolumns_zh = [\"方式\"]\n"
          "rows = [{ cells = [\"on\"], text = \"operational\", text_zh = \"运行\", line = \"13-14\" }, "
          "{ cells = [\"off\"], line = \"15\" }]\npicture = '''\n __\n'''\nnote = \"N\"\nnote_zh = \"注\"\n"
          "assumed = true\nfigure = true\nobject = \"0x6060:00\"\nvalue = -1\n",
      "f.topics.toml", "f");
  ASSERT_TRUE(topics) << topics.error().message.text();
  const auto& topic = topics->front();
  EXPECT_EQ(topic.family, "f");
  EXPECT_EQ(topic.also, std::vector<std::string>{"run light"});
  EXPECT_EQ(topic.rows.size(), 2U);
  EXPECT_EQ(topic.rows[0].line, "13-14");
  EXPECT_EQ(topic.picture, " __\n");
  EXPECT_TRUE(topic.assumed && topic.figure);
  EXPECT_EQ(topic.object, (ObjectAddress{0x6060, 0}));
  EXPECT_EQ(topic.value, -1);
  EXPECT_EQ(topic.note_zh, "注");
}

TEST(Topics, RefuseUnknownKeysAndWrongKindsWithTheirLine) {
  EXPECT_EQ(refusal("format = 1\n[[topics]]\n"), "f.topics.toml:2:3: unknown key 'topics'");
  EXPECT_EQ(refusal(kHead + "titel = \"x\"\n"), "f.topics.toml:3:1: unknown key 'titel'");
  EXPECT_EQ(refusal(kHead + "kind = \"plug\"\n"), "f.topics.toml:3:8: 'kind' cannot be \"plug\"");
  EXPECT_EQ(refusal(kHead + "line = 12\n"), "f.topics.toml:3:8: 'line' cannot be 12");
  EXPECT_EQ(refusal(kHead + "figure = \"yes\"\n"), "f.topics.toml:3:10: 'figure' cannot be \"yes\"");
  EXPECT_EQ(refusal(kHead + "also = [1]\n"), "f.topics.toml:3:8: 'also' cannot be this list");
  EXPECT_EQ(refusal(kHead + "rows = [{ cell = [] }]\n"), "f.topics.toml:3:11: unknown key 'cell'");
  EXPECT_EQ(refusal("[[topic]]\n" + kWhole.substr(kHead.size()) + kTexts),
            "f.topics.toml: 'format' is missing");
  EXPECT_EQ(refusal("format = 2\n"), "f.topics.toml:1:10: 'format' cannot be 2");
  EXPECT_EQ(refusal("topic = 1\n"), "f.topics.toml:1:9: 'topic' cannot be 1");
}

TEST(Topics, RefuseWhatIsMissingHalfOrTwice) {
  const auto in_topic = [](const std::string& rest) { return refusal(kWhole + rest); };
  const std::string at = "f.topics.toml:2:1: topic 'RUN': ";
  EXPECT_EQ(in_topic(kTexts), "none");
  EXPECT_EQ(refusal(kHead + "kind = \"led\"\n"), "f.topics.toml:2:1: 'name' is missing");
  EXPECT_EQ(refusal(kHead + "kind = \"led\"\nname = \"RUN\"\ntitle = \"a\"\ntitle_zh = \"b\"\n" + kTexts),
            at + "'line' is missing");
  EXPECT_EQ(in_topic("text = \"Green.\"\n"), at + "'text' and 'text_zh' go together");
  EXPECT_EQ(in_topic(kTexts + "note = \"N\"\n"), at + "'note' and 'note_zh' go together");
  EXPECT_EQ(in_topic(""), at + "it says nothing: 'text', 'rows' or 'picture' is missing");
  EXPECT_EQ(in_topic(kTexts + "value = 1\n"), at + "'value' needs 'object'");
  EXPECT_EQ(in_topic(kTexts + "columns = [\"a\"]\ncolumns_zh = [\"b\"]\n"),
            at + "'columns' and 'rows' go together");
  const std::string row = "rows = [\n{ cells = [\"1\"], line = \"2\" }]\n";
  EXPECT_EQ(in_topic("columns = [\"a\"]\n" + row), at + "1 'columns', but 0 'columns_zh'");
  EXPECT_EQ(in_topic("columns = [\"a\", \"b\"]\n" + row),
            "f.topics.toml:10:1: a row of 1 'cells' under 2 'columns'");
  const std::string columns = "columns = [\"a\"]\ncolumns_zh = [\"b\"]\n";
  EXPECT_EQ(in_topic(columns + "rows = [{ cells = [\"1\"] }]\n"), "f.topics.toml:10:9: a row without 'line'");
  EXPECT_EQ(in_topic(columns + "rows = [{ cells = [\"1\"], line = \"2\", text = \"t\" }]\n"),
            "f.topics.toml:10:9: a row has both 'text' and 'text_zh', or neither");
  const auto twice = kWhole + kTexts + "[[topic]]\n" + kWhole.substr(kHead.size()) + kTexts;
  EXPECT_EQ(refusal(twice), "f.topics.toml:10:1: topic 'RUN': its name appears twice in the file");
}

TEST(Topics, SayWhereTheyStandByLinesOrByAClause) {
  for (const auto* good : {"6692", "6692-6711", "6692-6711 6801", "CiA 402-2, 8.4.2", "ETG.1000.6"})
    EXPECT_TRUE(is_source_line(good)) << good;
  for (const auto* bad : {"", "0", "12-", "12-11", "12,13", "12  13", "-12", " 12", "12 clause"})
    EXPECT_FALSE(is_source_line(bad)) << bad;
}

TEST(Topics, OfAFamilyStandBeforeThoseOfItsParentsAndTakeTheirPlace) {
  const auto profile = load_profile("x1", kTopicFolders);
  ASSERT_TRUE(profile) << profile.error().message.text();
  const auto topics = load_topics(*profile, kTopicFolders);
  ASSERT_TRUE(topics) << topics.error().message.text();
  std::vector<std::string> names;
  for (const auto& topic : *topics) names.push_back(topic.family + " " + topic.name);
  // Method 7 is told by the family in its own words, without a picture.
  EXPECT_EQ(names, (std::vector<std::string>{"x1 CN3", "x1 method 7 of x1", "x1 DI functions", "cia402 pp",
                                             "cia402 homing method 7", "cia402 cable length"}));
  EXPECT_EQ(load_own_topics(*profile)->size(), 3U);
}

TEST(Topics, OfTheStandardHoldForAFamilyWithoutAParentAndForFiles) {
  for (const auto* drive : {"x2", "tests/cli/data/node.eds"}) {
    std::filesystem::current_path(source_dir());
    const auto profile = load_profile(drive, kTopicFolders);
    ASSERT_TRUE(profile) << profile.error().message.text();
    const auto topics = load_topics(*profile, kTopicFolders);
    ASSERT_TRUE(topics);
    EXPECT_TRUE(std::any_of(topics->begin(), topics->end(), [](const Topic& t) { return t.name == "pp"; }))
        << drive;
  }
}

std::vector<std::string> heads(const std::string& toml) {
  std::vector<std::string> out;
  const auto topics = parse_topic_heads(toml, "f.topics.toml", "f");
  if (!topics) return {topics.error().message.text()};
  for (const auto& topic : *topics)
    out.push_back(topic.kind + " " + topic.name + (topic.picture.empty() ? "" : " with a picture"));
  return out;
}

TEST(TopicNames, AreThoseOfTheTopicsInEveryFamily) {
  const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
  for (const auto* family : {"cia402", "gsd600", "dm", "da200", "sv2", "ts"}) {
    const auto profile = load_profile(family, folders);
    ASSERT_TRUE(profile) << profile.error().message.text();
    std::vector<std::string> whole;
    const auto topics = load_topics(*profile, folders);
    for (const auto& topic : *topics) whole.push_back(topic.name);
    EXPECT_EQ(topic_names(*profile, folders).value(), whole) << family;
  }
  const auto profile = load_profile("x1", kTopicFolders);
  EXPECT_EQ(topic_names(*profile, kTopicFolders).value().at(1), "method 7 of x1");
  EXPECT_EQ(topic_names(*profile, kTopicFolders).value().at(4), "homing method 7") << "only it has a picture";
}

TEST(TopicNames, AreFoundByTheirLinesAndElseInTheWholeFile) {
  const std::vector<std::string> run{"led RUN"};
  EXPECT_EQ(heads(kWhole + "text = \"not read any further\"\n"), run);
  EXPECT_EQ(heads(kWhole + kTexts + "picture = \"\"\"\n |\n\"\"\"\n"),
            (std::vector<std::string>{"led RUN with a picture"}));
  EXPECT_EQ(heads(kWhole + kTexts + "[words_zh]\nname = \"名称\"\n"), run);
  EXPECT_EQ(heads(kWhole + "text = \"\"\"\nname = \"other\"\n\"\"\"\ntext_zh = \"z\"\n"), run);
  const auto indented = "format = 1\n[[topic]]\nkind = \"led\"\n name = \"RUN\"" +
                        kWhole.substr(kWhole.find("\ntitle")) + kTexts;
  EXPECT_EQ(heads(indented), run);
  EXPECT_EQ(heads(kHead + "kind = \"led\"\n"),
            (std::vector<std::string>{"f.topics.toml:2:1: 'name' is missing"}));
}

TEST(Topics, AreNoFamilyAndAreReadByNobodyElse) {
  std::vector<std::string> found;
  for (const auto& family : find_families(kTopicFolders)) found.push_back(family.name);
  EXPECT_EQ(found, (std::vector<std::string>{"cia402", "x1", "x2"}));
  const auto broken = load_profile(source_dir() + "/tests/cli/data/broken/bad.toml", kTopicFolders);
  ASSERT_TRUE(broken) << broken.error().message.text();
  const auto topics = load_topics(*broken, kTopicFolders);
  ASSERT_FALSE(topics);
  EXPECT_EQ(topics.error().code, Errc::file);
  EXPECT_TRUE(
      topics.error().message.text().ends_with("bad.topics.toml:11:3: a row of 1 'cells' under 2 'columns'"));
}

}  // namespace
}  // namespace servoctl::drive
