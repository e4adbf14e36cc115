// Every rule, caution, label and note says where in the manual it comes from:
// tests/vectors/<family>-quotes.csv holds its key, the line, and characters that stand there.
// docs/drive-data.md describes the file.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <filesystem>
#include <ostream>
#include <set>

#include "base/csv.hpp"
#include "base/file.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/profile.hpp"
#include "drive/toml_reader.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

namespace fs = std::filesystem;

struct Manual {
  const char* family;
  const char* vendor;
  const char* file;
};

std::ostream& operator<<(std::ostream& out, const Manual& manual) { return out << manual.family; }

struct Quote {
  std::string key;
  std::optional<std::size_t> line;  ///< Empty: the manual does not state it, and the data says so.
  std::string text;
};

/// Without blanks and without the tags of the manuals' tables.
std::string bare(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto end = text[i] == '<' ? text.find('>', i) : std::string_view::npos;
    if (end != std::string_view::npos)
      i = end;
    else if (text[i] != ' ' && text[i] != '\t' && text[i] != '\r')
      out += text[i];
  }
  return out;
}

/// Keys of the rules in the file: `rule nmt.node_id`, `rule caution 2`, `rule pdo.types.254`.
void add_rules(const toml::table& table, const std::string& before, std::set<std::string>& out) {
  static const std::set<std::string_view> kNotRules{
      "format", "family", "vendor", "name", "name_zh", "parent", "assumed", "contradicted", "provenance"};
  for (const auto& [key, node] : table) {
    const std::string_view name = key.str();
    if (before.empty() && kNotRules.count(name) != 0) continue;
    const auto path = before + std::string(name);
    const bool sections = path == "caution" || path == "numbering" || path == "pdo.preset";
    if (before.empty() || path == "pdo.types") {
      if (const auto* inside = node.as_table()) {
        add_rules(*inside, path + ".", out);
        continue;
      }
    }
    const auto* array = node.as_array();
    for (std::size_t i = 1; sections && array != nullptr && i <= array->size(); ++i)
      out.insert(fmt::format("rule {} {}", path, i));
    if (!sections) out.insert("rule " + path);
  }
}

class Quotes : public testing::TestWithParam<Manual> {
 protected:
  void SetUp() override {
    auto loaded = load_profile(GetParam().family, kFolders);
    ASSERT_TRUE(loaded) << loaded.error().message.text();
    profile = std::move(*loaded);
    read_quotes();
    const auto toml = read_file(kFolders[0] / GetParam().vendor / fmt::format("{}.toml", GetParam().family));
    ASSERT_TRUE(toml);
    const auto parsed = toml::parse(*toml);
    ASSERT_TRUE(parsed);
    add_rules(parsed.table(), "", wanted);
    add_tables();
  }

  void read_quotes() {
    const auto path =
        fs::path(source_dir()) / "tests/vectors" / fmt::format("{}-quotes.csv", GetParam().family);
    const auto text = read_file(path);
    ASSERT_TRUE(text) << path;
    const auto table = parse_csv(*text, path.string());
    ASSERT_TRUE(table);
    for (const auto& row : table->rows) {
      ASSERT_EQ(row.cells.size(), 3U) << path << ":" << row.line;
      const auto line = parse_digits(row.cells[1], 10);
      ASSERT_TRUE(line || row.cells[1].empty()) << path << ":" << row.line;
      ASSERT_FALSE(row.cells[2].empty()) << path << ":" << row.line;
      quotes.push_back({row.cells[0], line ? std::optional<std::size_t>(*line) : std::nullopt, row.cells[2]});
    }
  }

  void add(std::string_view table, std::string_view id, bool says_something, const od::Doubts& doubts) {
    if (says_something) wanted.insert(fmt::format("{} {}", table, id));
    for (const auto* marks : {&doubts.assumed, &doubts.contradicted})
      for (const auto& mark : *marks)
        for (const auto line : mark.lines) marks_at.insert({fmt::format("mark {} {}", id, mark.field), line});
  }

  void add_tables() {
    for (const auto& object : profile.dictionary.objects())
      for (const auto& e : object.entries)
        add("objects", fmt::format("0x{:04X}:{:02X}", e.address.index, e.address.sub),
            !e.note.empty() || !e.labels.empty(), e.doubts);
    if (profile.made_of_dictionary) profile.parameters.clear();  // Its objects were added.
    for (const auto& p : profile.parameters)
      add("params", p.id, !p.note.empty() || !p.note_zh.empty() || !p.labels.empty(), p.doubts);
    for (const auto& f : profile.faults)
      add("faults",
          !f.panel.empty() ? f.panel
          : f.code         ? fmt::format("0x{:04X}", *f.code)
                           : f.name,
          !f.check.empty(), f.doubts);
    for (const auto& mark : profile.rules.contradicted)
      for (const auto line : mark.lines) marks_at.insert({"mark rules " + mark.field, line});
  }

  Profile profile;
  std::vector<Quote> quotes;
  std::set<std::string> wanted;
  std::set<std::pair<std::string, std::size_t>> marks_at;  ///< Keys of marks with each of their lines.
};

TEST_P(Quotes, StandForEveryRuleCautionLabelAndNoteAndForNothingElse) {
  std::set<std::string> found;
  std::set<std::pair<std::string, std::size_t>> found_marks;
  for (const auto& quote : quotes) {
    if (quote.key.starts_with("mark "))
      found_marks.insert({quote.key, quote.line.value_or(0)});
    else
      found.insert(quote.key);
  }
  for (const auto& key : wanted) EXPECT_TRUE(found.count(key) != 0) << "no quote for '" << key << "'";
  for (const auto& key : found)
    EXPECT_TRUE(wanted.count(key) != 0) << "a quote for '" << key << "', which is not there";
  for (const auto& [key, line] : marks_at)
    EXPECT_TRUE(found_marks.count({key, line}) != 0) << "no quote for '" << key << "' at " << line;
  for (const auto& [key, line] : found_marks)
    EXPECT_TRUE(marks_at.count({key, line}) != 0)
        << "a quote for '" << key << "' at " << line << ", which is not there";
}

/// A rule without a line is one the family's file lists as assumed; of a table's line some field must be.
TEST_P(Quotes, WithoutALineBelongToWhatIsMarkedAsAssumed) {
  const auto& assumed = profile.rules.assumed;
  for (const auto& quote : quotes) {
    if (quote.line || !quote.key.starts_with("rule ")) continue;
    const auto key = quote.key.substr(5);
    const auto section = key.substr(0, key.find('.'));
    EXPECT_TRUE(std::find(assumed.begin(), assumed.end(), key) != assumed.end() ||
                std::find(assumed.begin(), assumed.end(), section) != assumed.end())
        << quote.key;
  }
}

TEST_P(Quotes, StandInTheManualAtTheirLine) {
  // Beside the project; a second working tree of it lies one folder deeper.
  std::string text;
  for (const auto* place : {"../shared/seeds", "../../shared/seeds"})
    if (const auto found = read_file(fs::path(source_dir()) / place / fmt::format("{}.txt", GetParam().file));
        found && text.empty())
      text = *found;
  if (text.empty()) GTEST_SKIP() << "the manuals are not beside the sources";
  const auto lines = split(std::string_view(text), '\n');
  for (const auto& quote : quotes) {
    if (!quote.line) continue;
    ASSERT_LE(*quote.line, lines.size()) << quote.key;
    const auto there = bare(lines[*quote.line - 1]);
    EXPECT_NE(there.find(bare(quote.text)), std::string::npos)
        << GetParam().family << " " << quote.key << ": line " << *quote.line << " does not say '"
        << quote.text << "'";
  }
}

INSTANTIATE_TEST_SUITE_P(Manuals, Quotes,
                         testing::Values(Manual{"gsd600", "vmmore", "gsd600-canopen-manual"},
                                         Manual{"dm", "dm", "dm-canopen-manual"},
                                         Manual{"da200", "invt", "da200-canopen-guide"},
                                         Manual{"sv2", "sinsegye", "sv2-ethercat-manual"},
                                         Manual{"ts", "syntron", "ts-modbus-canopen-manual"}));

}  // namespace
}  // namespace servoctl::drive
