// The codes of `doctor` are known to `explain` and to docs/field.md, all of them and no others.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "drive/topics.hpp"
#include "tests/source_dir.hpp"

namespace servoctl {
namespace {

std::string content(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

std::set<std::string> all_of(const std::string& text, const std::regex& pattern) {
  std::set<std::string> out;
  for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at)
    out.insert(at->str(1));
  return out;
}

/// Behind its level, where a finding is made.
std::set<std::string> codes_of_sources() {
  std::set<std::string> out;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(source_dir()) / "src/traffic")) {
    const auto text = content(entry.path());
    for (const auto* pattern :
         {R"re(Level::[a-z]+,\s*"([a-z0-9-]+)")re", R"re(now \? "(port[a-z-]+)")re",
          R"re(: "(port-had[a-z-]+)")re", R"re(\? Level::fault : Level::note, "([a-z-]+)")re"})
      out.merge(all_of(text, std::regex(pattern)));
  }
  return out;
}

std::set<std::string> codes_of_page() {
  const auto text = content(std::filesystem::path(source_dir()) / "docs/field.md");
  std::set<std::string> out;
  std::istringstream lines(text.substr(text.find("| code | what was seen |")));
  for (std::string line; std::getline(lines, line) && line.starts_with('|');)
    out.merge(all_of(line.substr(0, line.find('|', 1)), std::regex("`([a-z0-9-]+)`")));
  return out;
}

/// The findings of a file that are no `ok`, without what stands in quotes: `{Level::note,"…",…}`; what is
/// empty stays `""`.
std::vector<std::string> findings_in(const std::string& text) {
  static const std::regex quoted(R"re("((?:\\.|[^"\\])*)")re");
  std::string bare;
  auto from = text.begin();
  for (std::sregex_iterator at(text.begin(), text.end(), quoted), end; at != end; ++at) {
    bare.append(from, (*at)[0].first).append(at->length(1) == 0 ? "\"\"" : "\"…\"");
    from = (*at)[0].second;
  }
  bare.append(from, text.end());
  std::vector<std::string> out;
  static const std::regex begin(
      R"re(\{\s*(?:Finding::)?Level::fault|\{\s*(?:Finding::)?Level::note|\{\*load|\{now)re");
  for (std::sregex_iterator at(bare.begin(), bare.end(), begin), end; at != end; ++at) {
    auto stop = static_cast<std::size_t>(at->position());
    int depth = 0;
    do {
      depth += bare[stop] == '{' ? 1 : bare[stop] == '}' ? -1 : 0;
      ++stop;
    } while (depth > 0 && stop < bare.size());
    out.push_back(bare.substr(static_cast<std::size_t>(at->position()),
                              stop - static_cast<std::size_t>(at->position())));
  }
  return out;
}

TEST(FindingCodes, AllSayWhatTheyMeanAndWhatMendsThem) {
  std::size_t count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(source_dir()) / "src/traffic"))
    for (const auto& finding : findings_in(content(entry.path()))) {
      ++count;
      EXPECT_EQ(finding.find("{}"), std::string::npos) << entry.path() << ": " << finding;
      EXPECT_FALSE(std::regex_search(finding, std::regex(R"re(,\s*""\s*[},])re")))
          << entry.path() << ": " << finding;
    }
  EXPECT_GT(count, 30U);
}

TEST(FindingCodes, AreKnownToExplainAndToThePage) {
  const auto file = std::filesystem::path(source_dir()) / "eds/cia/cia402.topics.toml";
  const auto topics = drive::parse_topics(content(file), file.string(), "cia402");
  ASSERT_TRUE(topics) << topics.error().message.text();
  std::set<std::string> explained;
  for (const auto& topic : *topics)
    if (topic.name == "doctor findings")
      for (const auto& row : topic.rows) explained.insert(row.cells.front());
  const auto made = codes_of_sources();
  EXPECT_GT(made.size(), 30U);
  EXPECT_EQ(explained, made);
  EXPECT_EQ(codes_of_page(), made);
}

}  // namespace
}  // namespace servoctl
