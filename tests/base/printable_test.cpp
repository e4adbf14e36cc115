// What foreign text may not do to a terminal, and to a spreadsheet.
#include "base/printable.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <string>

#include "base/csv.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"

namespace servoctl {
namespace {

TEST(Printable, WritesControlCharactersOut) {
  EXPECT_EQ(printable("a\nb\tc\rd\x1B[2J\x7F"), "a\\nb\\tc\\rd\\x1B[2J\\x7F");
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
  EXPECT_EQ(printable("位置 é \\x1B 😀"), "位置 é \\x1B 😀");
}

TEST(Printable, WritesOutWhatTurnsTheTextAroundHidesOrEndsALine) {
  EXPECT_EQ(printable("a\u202Eb\u2066c\u200Fd\u061Ce"), "a\\u202Eb\\u2066c\\u200Fd\\u061Ce");
  EXPECT_EQ(printable("\u2028\u2029\u200B\u200D\u2060\uFEFF\u00AD\uFE0F"),
            "\\u2028\\u2029\\u200B\\u200D\\u2060\\uFEFF\\u00AD\\uFE0F");
  EXPECT_EQ(printable("\U000E0041\U000E01EF"), "\\U000E0041\\U000E01EF");
  EXPECT_EQ(printable("\xEF\xBF\xBE\xEF\xB7\x90\xF0\x9F\xBF\xBF"), "\\uFFFE\\uFDD0\\U0001FFFF");
}

TEST(Printable, KnowsControlsOfEightBitsAsBytesAndAsUtf8) {
  EXPECT_EQ(printable("\x9B"
                      "31m"),
            "\\x9B31m");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\u009B31m");
}

TEST(Printable, WritesOutBytesThatAreNoUtf8) {
  EXPECT_EQ(printable("\xC0\xAF"), "\\xC0\\xAF");                    // overlong
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xED\\xA0\\x80");           // surrogate
  EXPECT_EQ(printable("\xF8\x90\x80\x80"), "\\xF8\\x90\\x80\\x80");  // five bytes once began so
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80");  // beyond Unicode
  EXPECT_EQ(printable("\xE4\xBD"), "\\xE4\\xBD");
  EXPECT_FALSE(is_utf8("\xF8\x90\x80\x80"));
}

TEST(Printable, LeavesOurOwnLineBreaksInTextOfSeveralLines) {
  EXPECT_EQ(printable_lines("a\n\tb\r\x1B\n"), "a\n\tb\\r\\x1B\n");
}

TEST(Printable, IsMeasuredAsItIsShown) {
  EXPECT_EQ(display_width(printable("a\u202Eb")), 8U);
  EXPECT_EQ(display_width("e\u0301"), 1U);
  EXPECT_EQ(display_width("😀"), 2U);
}

/// Any code point, hostile ones often.
rc::Gen<std::string> some_text() {
  return rc::gen::container<std::string>(rc::gen::oneOf(
      rc::gen::arbitrary<char>(),
      rc::gen::elementOf(std::string("\x1B\x9B\xC2\xE2\x80\xAE\xEF\xBB\xBF\xF3\xA0\x81\n\t ="))));
}

RC_GTEST_PROP(PrintableProperty, OfAnyBytesIsCleanUtf8AndStaysAsItIs, ()) {
  const auto shown = printable(*some_text());
  RC_ASSERT(is_utf8(shown));
  RC_ASSERT(printable(shown) == shown);
  for (std::string_view rest = shown; !rest.empty();) {
    const auto c = decode_utf8(rest);
    RC_ASSERT(!is_hidden_or_control(*c.value));
    rest.remove_prefix(c.size);
  }
}

TEST(CsvCell, ThatASpreadsheetWouldRunIsKeptFromIt) {
  EXPECT_EQ(csv_cell("=1+1"), "'=1+1");
  EXPECT_EQ(csv_cell("=HYPERLINK(\"x\",\"y\")"), "\"'=HYPERLINK(\"\"x\"\",\"\"y\"\")\"");
  EXPECT_EQ(csv_cell("+cmd"), "'+cmd");
  EXPECT_EQ(csv_cell("-cmd|' /C calc'!A0"), "'-cmd|' /C calc'!A0");
  EXPECT_EQ(csv_cell("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(csv_cell("\t=1"), "'\t=1");
  EXPECT_EQ(csv_cell("\r=1"), "\"'\r=1\"");
  EXPECT_EQ(csv_cell(" =1"), "' =1");
  EXPECT_EQ(csv_cell("＝1"), "'＝1");
  EXPECT_EQ(csv_cell("'=1"), "''=1");
}

TEST(CsvCell, ThatIsANumberOrAPlainTextStaysAsItIs) {
  for (const auto* cell : {"-5", "+7", "-0.25", "-1e-3", "0x1F", "a=b", "'quoted'", "", "x-y", "Pn0100"})
    EXPECT_EQ(csv_cell(cell), cell);
}

RC_GTEST_PROP(CsvProperty, EveryCellComesBackAndNoneBeginsAFormula, ()) {
  const auto cells = *rc::gen::container<std::vector<std::string>>(3, some_text());
  std::string text = "a,b,c\n";
  for (std::size_t i = 0; i < cells.size(); ++i) text += (i == 0 ? "" : ",") + csv_cell(cells[i]);
  // Three empty cells are told from an empty line by their commas.
  const auto table = parse_csv(text + "\n", "x.csv");
  RC_ASSERT(table.has_value());
  RC_ASSERT(table->rows.size() == 1U);
  RC_ASSERT(table->rows.front().cells == cells);
  for (const auto& cell : cells) {
    auto written = csv_cell(cell);
    if (written.starts_with('"')) written.erase(0, 1);
    if (written.empty() || parse_real(written)) continue;
    RC_ASSERT(std::string_view("=+-@\t\r").find(written.front()) == std::string_view::npos);
  }
}

}  // namespace
}  // namespace servoctl
