// What terminals get: nothing wider than the window, ASCII where the locale has nothing else, colours.
#include <gtest/gtest.h>

#include "base/number.hpp"
#include "base/text.hpp"
#include "cli/terminal/ascii_form.hpp"
#include "cli/terminal/colour.hpp"
#include "cli/terminal/fitted.hpp"
#include "golden_cases.hpp"
#include "report/catalogue.hpp"
#include "report/value.hpp"
#include "show/fault_records.hpp"

namespace servoctl::cli {
namespace {

/// Lines that are no text for people: what was typed, and JSON.
bool is_for_people(std::string_view line) {
  return !line.starts_with("$ ") && !line.starts_with("{") && !line.starts_with("[");
}

/// A word, such as a path, a rule or what a drive says of itself, that would fill a line by itself is not
/// broken.
bool has_long_word(std::string_view line) {
  constexpr std::size_t kLong = 64;
  const auto words = split(line, ' ');
  return std::any_of(words.begin(), words.end(),
                     [](std::string_view word) { return display_width(word) > kLong; });
}

/// Whether what is written out as `\\u901F` is Chinese, or what a hostile name has.
bool writes_chinese_alone(std::string_view line) {
  constexpr std::string_view kWritten = "\\u";
  constexpr std::uint64_t kFirstOfEast = 0x2E80;
  for (auto at = line.find(kWritten); at != std::string_view::npos; at = line.find(kWritten, at + 1)) {
    const auto code = parse_digits(line.substr(at + kWritten.size(), 4), 16);
    const bool hides = code && ((*code >= 0x200B && *code <= 0x206F) || *code == 0xFEFF || *code < 0xA0);
    if (code && *code < kFirstOfEast && !hides) return false;
  }
  return true;
}

class Window : public testing::TestWithParam<GoldenCase> {};

TEST_P(Window, OfEightyColumnsHoldsEveryLine) {
  const auto played = play_golden(GetParam(), "", [](RecordingConsole& console) { console.columns = 80; });
  for (const auto line : split(std::string_view(played.said), '\n'))
    if (is_for_people(line) && !has_long_word(line)) {
      EXPECT_LE(display_width(line), 80U) << line;
    }
}

TEST_P(Window, WithoutUtf8GetsAsciiAlone) {
  const auto played =
      play_golden(GetParam(), " --lang en", [](RecordingConsole& console) { console.set_ascii(true); });
  for (const auto line : split(std::string_view(played.said), '\n')) {
    if (!is_for_people(line)) continue;
    const bool ascii =
        std::all_of(line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
    EXPECT_TRUE(ascii) << line;
    EXPECT_TRUE(writes_chinese_alone(line)) << "a sign of ours has no ASCII form: " << line;
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Window, testing::ValuesIn(golden_cases()),
                         [](const testing::TestParamInfo<GoldenCase>& c_info) {
                           auto name = c_info.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(AsciiForm, TakesTheBlanksBehindASignOfSeveralLetters) {
  EXPECT_EQ(ascii_form("a… b"), "a... b");
  EXPECT_EQ(ascii_form("≤ 0       next"), "<= 0      next");
  EXPECT_EQ(ascii_form("90° 3 µs 2·m² ⣿▁█ ┤"), "90deg 3 us 2.m2 *_# |");
  EXPECT_EQ(ascii_form("速\n"), "\\u901F\n");
}

TEST(Fitted, BreaksLinesAtBlanksAndGoesOnBelowTheText) {
  EXPECT_EQ(fitted("error: one two three", 14), "error: one\n  two three");
  EXPECT_EQ(fitted("  hint: one two three\nshort\n", 15), "  hint: one\n    two three\nshort\n");
  EXPECT_EQ(fitted("caution  one two three", 18), "caution  one two\n         three");
  EXPECT_EQ(fitted("0x6041:0 is one word of a/very/long/path", 20),
            "0x6041:0 is one\n  word of\n  a/very/long/path");
  EXPECT_EQ(fitted("Is it clear? [y/N] ", 80), "Is it clear? [y/N] ");
}

TEST(Coloured, AreWordsThatStandAloneAndMeanSomething) {
  EXPECT_EQ(coloured("error: fault\n"), "\x1B[31merror: \x1B[0mfault\n");
  EXPECT_EQ(coloured("node  NMT  fault  failed\n   1  pre-operational  fault  6 hm"),
            "node  NMT  fault  failed\n   1  pre-operational  \x1B[31mfault\x1B[0m  6 hm");
  EXPECT_EQ(coloured("node  1\nfault  none\n\nresult  failed\nfailed  0"),
            "node  1\nfault  none\n\nresult  failed\nfailed  0")
      << "names of what follows, and column heads, are no verdicts";
  EXPECT_EQ(coloured("caution  the fault of it"), "\x1B[33mcaution\x1B[0m  the fault of it");
  EXPECT_EQ(coloured("no fault here"), "no fault here");
  EXPECT_EQ(coloured("        fault"), "        fault") << "the second line of a cell";
}

TEST(Coloured, IsTheFaultWithoutACodeInBothLanguages) {
  const std::string cell(trim(report::to_text(show::ToldFault{true, {}, "in fault"}.cell(0))));
  for (const auto& told : {cell, report::in_chinese(cell)})
    EXPECT_EQ(coloured("node  fault\n   1  " + told), "node  fault\n   1  \x1B[31m" + told + "\x1B[0m");
}

TEST(Coloured, IsTextForPeopleAndNoJson) {
  RecordingConsole console;
  console.set_colour(Colour::always);
  console.out("node  state\n1  fault\n");
  console.json("1  fault\n");
  EXPECT_EQ(console.out_text, "node  state\n1  \x1B[31mfault\x1B[0m\n1  fault\n");
  console.set_colour(Colour::never);
  console.err("error: it\n");
  EXPECT_EQ(console.err_text, "error: it\n");
}

}  // namespace
}  // namespace servoctl::cli
