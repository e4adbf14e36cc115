// What a hostile or broken file may cost: little time, a report of bounded length.
#include <algorithm>
#include <chrono>
#include <random>

#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

constexpr std::size_t kSome = 1U << 20U;  // Enough for anything quadratic to be seen.

std::string repeated(std::string_view unit, std::size_t bytes) {
  std::string out;
  while (out.size() < bytes) out += unit;
  return out;
}

/// Reads it; the time is checked loosely, because sanitizers are slow and machines busy.
Result<EdsFile> read_in_time(const std::string& text) {
  const auto start = std::chrono::steady_clock::now();
  auto file = read_eds(text, "x.eds");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  return file;
}

TEST(EdsBounds, RefuseAFileAboveTheLimitUnread) {
  const auto file = read_in_time(std::string(kMostEdsBytes + 1, 'x'));
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, Errc::file);
  EXPECT_EQ(file.error().message.text(), "x.eds: 32 MiB is too large for an EDS");
}

TEST(EdsBounds, ReadAFileAtTheLimit) {
  auto text = variable("2000", "7", "") + ";";
  text.resize(kMostEdsBytes, 'x');
  EXPECT_TRUE(read_in_time(text));
}

TEST(EdsBounds, RefuseBytesThatAreNoText) {
  std::mt19937 random(1);
  std::string text(kSome, '\0');
  for (auto& c : text) c = static_cast<char>(random());
  const auto file = read_in_time(text);
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().message.text(), "x.eds: not a text file");
}

TEST(EdsBounds, HoldForOneLongLine) {
  for (const auto* unit : {"x", "[", "=", "$nodeid+", "[1000=", "\x81\x81"})
    EXPECT_FALSE(read_in_time(repeated(unit, kSome))) << unit;
}

TEST(EdsBounds, HoldForMillionsOfLines) {
  const auto good = variable("2FFF", "7", "");
  for (const auto* unit : {"[2000]\n", "[]\n", "[2000sub1]\n", "[1000subFFF]\n", "[Coments]\n", "[x\n",
                           "a=\n", "=\n", "?\n", "# =\n", "[2000Name]\n", "[OptionalObjects]\n1=5\n", "\n"}) {
    const auto file = read_in_time(good + repeated(unit, kSome));
    ASSERT_TRUE(file) << unit;
    EXPECT_LE(file->diagnostics.size(), 1300U) << unit;
  }
}

TEST(EdsBounds, LimitTheEntriesThatCompactSubObjMakes) {
  std::string text;
  for (int i = 0; i < 3000; ++i)
    text += variable(std::to_string(2000 + i), "5", "ObjectType=8\nCompactSubObj=254");
  const auto file = read_in_time(text);
  ASSERT_TRUE(file);
  EXPECT_LE(file->dictionary.entry_count(), 101'000U);
  EXPECT_TRUE(std::any_of(file->diagnostics.begin(), file->diagnostics.end(),
                          [](const auto& d) { return d.rule == "too-many-entries"; }));
}

TEST(EdsBounds, CountWhatTheyLeaveOut) {
  const auto file = read(variable("2000", "7", "") + repeated("?\n", 2000));
  EXPECT_EQ(file.diagnostics.size(), 201U);
  EXPECT_EQ(file.error_count(), 1000U);
  EXPECT_EQ(file.warning_count(), 0U);
  EXPECT_EQ(file.diagnostics.back().message, "800 more of this rule are left out");
}

TEST(EdsBounds, CountEveryFindingOfARuleOnce) {
  struct Row {
    const char* rule;
    const char* first;
    const char* unit;
  };
  for (const auto& row :
       {Row{"stray-line", "", "?\n"}, Row{"foreign-comment", "", "# c\n"},
        Row{"merge-marker", "", "<<<<<<<\n"}, Row{"unknown-section", "", "[Parameters]\nDataType=5\n"},
        Row{"misspelt-section", "", "[Coments]\n"}, Row{"unclosed-section", "", "[Comments\n"},
        Row{"duplicate-section", "[DeviceInfo]\n", "[DeviceInfo]\n"}, Row{"duplicate-key", "a=\n", "a=\n"},
        Row{"listed-but-absent", "[ManufacturerObjects]\n1=0x2FFF\n", "[ManufacturerObjects]\n1=0x3000\n"}}) {
    std::string text = variable("2FFF", "7", "") + row.first;
    for (int i = 0; i < 203; ++i) text += row.unit;
    const auto file = read(text);
    EXPECT_EQ(file.diagnostics.size(), 201U) << row.rule;
    EXPECT_EQ(file.error_count() + file.warning_count(), 203U) << row.rule;
    for (const auto& d : file.diagnostics) EXPECT_EQ(d.rule, row.rule);
  }
}

TEST(EdsBounds, HoldForValuesOfAnyLengthInMessages) {
  const std::string longest(100'000, '7');
  for (const auto* key : {"DefaultValue=", "AccessType=", "PDOMapping=", "ObjectType=", "DataType="}) {
    const auto file = read_eds(variable("2000", "7", "") + variable("2001", "7", key + longest), "x.eds");
    ASSERT_TRUE(file) << key;
    ASSERT_FALSE(file->diagnostics.empty()) << key;
    for (const auto& d : file->diagnostics) EXPECT_LT(d.message.size(), 400U) << d.rule;
  }
}

}  // namespace
}  // namespace servoctl::od
