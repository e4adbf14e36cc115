#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>
#include <filesystem>
#include <limits>

#include "base/bytes.hpp"
#include "base/csv.hpp"
#include "base/duration.hpp"
#include "base/file.hpp"
#include "base/number.hpp"
#include "base/object_address.hpp"
#include "base/offer.hpp"
#include "base/result.hpp"
#include "base/text.hpp"

namespace servoctl {
namespace {

using namespace std::chrono_literals;

TEST(ExitCode, IsTheOneScriptsRelyOn) {
  const std::pair<Errc, std::pair<int, std::string_view>> rows[] = {
      {Errc::negative, {1, "negative"}},
      {Errc::usage, {2, "usage"}},
      {Errc::bus, {3, "bus"}},
      {Errc::timeout, {4, "no-answer"}},
      {Errc::sdo_abort, {5, "sdo-abort"}},
      {Errc::protocol, {6, "protocol"}},
      {Errc::file, {7, "file"}},
      {Errc::refused, {8, "refused"}},
      {Errc::bug, {70, "bug"}},
      {Errc::interrupted, {130, "interrupted"}}};
  for (const auto& row : rows) {
    EXPECT_EQ(exit_code(row.first), row.second.first);
    EXPECT_EQ(name(row.first), row.second.second);
  }
}

TEST(Integer, IsReadAsPeopleWriteIt) {
  const auto value = [](std::string_view text) { return parse_signed(text); };
  EXPECT_EQ(value("100"), 100);
  EXPECT_EQ(value("-5"), -5);
  EXPECT_EQ(value("+7"), 7);
  EXPECT_EQ(value("0x64"), 100);
  EXPECT_EQ(value("0X64"), 100);
  EXPECT_EQ(value("64h"), 100);
  EXPECT_EQ(value("-10H"), -16);
  EXPECT_EQ(value("010"), 10);
  EXPECT_EQ(value("0b101"), 5);
  EXPECT_EQ(parse_integer("18446744073709551615")->as_unsigned(), 18446744073709551615U);
  EXPECT_EQ(value("18446744073709551615"), std::nullopt);
  EXPECT_EQ(value("x"), std::nullopt);
  EXPECT_EQ(value("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(value("-9223372036854775809"), std::nullopt);
  EXPECT_EQ(parse_integer("-1")->as_unsigned(), std::nullopt);
}

TEST(Integer, WithAnythingElseInItIsNone) {
  for (const auto* text :
       {"", "-", "+", "0x", "h", "1 ", " 1", "1.5", "12a", "--1", "0x1G", "18446744073709551616", "１"})
    EXPECT_FALSE(parse_integer(text)) << text;
}

TEST(Real, HasAPointWhateverTheLocale) {
  EXPECT_EQ(parse_real("1.5"), 1.5);
  EXPECT_EQ(parse_real("-.25"), -0.25);
  EXPECT_EQ(parse_real("+1e3"), 1000);
  for (const auto* text : {"", "1,5", "inf", "nan", "1e999", "1.5x", "+-1"})
    EXPECT_FALSE(parse_real(text)) << text;
}

TEST(Bytes, GoToHexAndBack) {
  EXPECT_EQ(to_hex(Bytes{0x00, 0x64, 0xFF}), "00 64 FF");
  EXPECT_EQ(parse_hex_bytes("00 64ff"), (Bytes{0x00, 0x64, 0xFF}));
  EXPECT_EQ(parse_hex_bytes(""), Bytes{});
  for (const auto* text : {"0", "0 0", "0G", "00 6"}) EXPECT_FALSE(parse_hex_bytes(text)) << text;
}

RC_GTEST_PROP(Bytes, AreLittleEndian, (std::uint64_t value)) {
  const auto bytes = store_le(value, 8);
  RC_ASSERT(bytes[0] == (value & 0xFFU));
  RC_ASSERT(bytes[7] == value >> 56U);
  RC_ASSERT(load_le(bytes) == value);
}

TEST(ObjectAddress, IsReadInEverySpelling) {
  const ObjectAddress plain{0x6041, 0};
  for (const auto* text : {"0x6041", "6041h", "6041", "6041H", "0X6041", "0x6041:0", "6041h.00", "6041sub0"})
    EXPECT_EQ(parse_object_address(text), plain) << text;
  EXPECT_EQ(parse_object_address("0x2000:65"), (ObjectAddress{0x2000, 0x65}));
  EXPECT_EQ(parse_object_address("2000h:65h"), (ObjectAddress{0x2000, 0x65}));
  EXPECT_EQ(parse_object_address("2000SUB1f"), (ObjectAddress{0x2000, 0x1F}));
  for (const auto* text :
       {"", "60", "604", "60411", "0x60411", "0x6041:", "0x6041:100", "6041-1", "pn202", "0x", "6041:g"})
    EXPECT_FALSE(parse_object_address(text)) << text;
}

TEST(ObjectAddress, SaysItsSubIndexIsHexadecimalWhereDecimalWouldBeAnother) {
  EXPECT_EQ(to_string(ObjectAddress{0x6041, 0}), "0x6041:0");
  EXPECT_EQ(to_string(ObjectAddress{0x6099, 9}), "0x6099:9");
  EXPECT_EQ(to_string(ObjectAddress{0x2001, 0x0A}), "0x2001:0Ah");
  EXPECT_EQ(to_string(ObjectAddress{0x2001, 0x10}), "0x2001:10h");
  EXPECT_EQ(to_string(ObjectAddress{0x2001, 0xFF}), "0x2001:FFh");
}

TEST(ObjectAddress, IsInDoubtWhereDigitsAloneWouldBeAnotherInDecimal) {
  EXPECT_EQ(doubtful_sub("2001:10"), "10");
  EXPECT_EQ(doubtful_sub("0x2001.15"), "15");
  EXPECT_EQ(doubtful_sub("2001SUB010"), "010");
  for (const auto* text :
       {"2001:10h", "2001:0x10", "2001:1F", "2001:9", "2001:09", "2010", "Pn0215", "P0.10"})
    EXPECT_FALSE(doubtful_sub(text)) << text;
}

RC_GTEST_PROP(ObjectAddress, IsPrintedInTheFormThatIsRead, (std::uint16_t index, std::uint8_t sub)) {
  RC_ASSERT(parse_object_address(to_string(ObjectAddress{index, sub})) == (ObjectAddress{index, sub}));
}

TEST(Duration, OfABareNumberIsAskedForItsUnit) {
  for (const auto* text : {"2", "0", "250", "1.5", "0x10"}) {
    const auto time = read_duration(text);
    ASSERT_FALSE(time) << text;
    EXPECT_EQ(time.error().message.text(), "'" + std::string(text) + "': a time needs its unit");
    EXPECT_NE(time.error().hint.text().find(std::string(text) + "ms"), std::string::npos);
  }
  EXPECT_EQ(read_duration("2s").value(), 2s);
  EXPECT_EQ(read_duration("soon").error().message.text(), "'soon' is not a time");
}

TEST(Duration, IsReadWithItsUnit) {
  EXPECT_EQ(parse_duration("250ms"), 250ms);
  EXPECT_EQ(parse_duration("1.5s"), 1500ms);
  EXPECT_EQ(parse_duration("100 us"), 100us);
  EXPECT_EQ(parse_duration("2min"), 2min);
  for (const auto* text : {"", "soon", "-1s", "1h", "1e99s", "5 parsecs", "nans", "infs", "+-1s", "0.1us"})
    EXPECT_FALSE(parse_duration(text)) << text;
  EXPECT_EQ(to_string(Duration(2s)), "2 s");
  EXPECT_EQ(to_string(Duration(250ms)), "250 ms");
  EXPECT_EQ(to_string(Duration(120us)), "120 us");
}

TEST(DisplayWidth, CountsChineseAsTwoColumns) {
  EXPECT_EQ(display_width("abc"), 3U);
  EXPECT_EQ(display_width("位置"), 4U);
  EXPECT_EQ(display_width("é"), 1U);
  EXPECT_EQ(display_width("e\u0301"), 1U);
  EXPECT_EQ(display_width("\xFF\xFE"), 2U);
  EXPECT_EQ(display_width("\xE4\xBD"), 2U);
  EXPECT_EQ(pad_right("位", 4), "位  ");
  EXPECT_EQ(pad_left("位", 4), "  位");
}

TEST(Clip, CutsNoCharacterInTwo) {
  EXPECT_EQ(clip("abcdef", 4), "abc…");
  EXPECT_EQ(clip("abcd", 4), "abcd");
  EXPECT_EQ(clip("位置环增益", 5), "位置…");
  EXPECT_EQ(clip("位置环增益", 4), "位…");
  EXPECT_EQ(clip("abc", 0), "");
}

TEST(Wrapped, BeginsEachParagraphAnewAndKeepsACommandInOneLine) {
  EXPECT_EQ(wrapped("one two three\n\nfour five six", 0, 10), "one two\nthree\n\nfour five\nsix");
  EXPECT_EQ(wrapped("then `test home` says it", 2, 14), "then\n  `test home`\n  says it");
  EXPECT_EQ(wrapped("先执行`test home`再看", 0, 12), "先执行\n`test home`\n再看");
  EXPECT_EQ(wrapped("a `b c", 0, 4), "a `b\nc");
}

TEST(Split, KeepsEmptyPartsButMakesNoneOfNothing) {
  EXPECT_EQ(split(std::string_view("a,,b"), ','), (std::vector<std::string_view>{"a", "", "b"}));
  EXPECT_EQ(split(std::string_view("a,"), ','), (std::vector<std::string_view>{"a", ""}));
  EXPECT_TRUE(split(std::string_view(""), ',').empty());
}

TEST(EditDistance, CountsASwapAsOne) {
  EXPECT_EQ(edit_distance("statuswrod", "statusword"), 1U);
  EXPECT_EQ(edit_distance("READ", "read"), 0U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
}

TEST(Nearest, OffersTheBestFirstAndNothingFarOff) {
  const std::vector<std::string> words{"read", "write", "reset", "scan"};
  EXPECT_EQ(nearest("raed", words), std::vector<std::string>{"read"});
  EXPECT_EQ(nearest("rese", words), (std::vector<std::string>{"reset", "read"}));
  EXPECT_TRUE(nearest("xyzzy", words).empty());
  EXPECT_EQ(did_you_mean("raed", words).text(), "did you mean read?");
  EXPECT_EQ(did_you_mean("xyzzy", words).text(), "");
  EXPECT_EQ(one_of(words).text(), "read, write, reset or scan");
  EXPECT_EQ(one_of(std::vector<std::string>(20000, "a")).text().size(), 3U * 20000U) << "no word nests";
}

TEST(Csv, ReadsTheCellsItWrites) {
  EXPECT_EQ(csv_cell("plain text"), "plain text");
  EXPECT_EQ(csv_cell("a, b"), "\"a, b\"");
  for (const std::string text : {"", "a,b", "say \"hi\"", "two\nlines", "\r"}) {
    const auto table = parse_csv("id,text\n1," + csv_cell(text) + "\n", "t.csv");
    ASSERT_TRUE(table) << table.error().message.text();
    EXPECT_EQ(table->rows.at(0).cells.at(1), text);
  }
}

TEST(Csv, KnowsQuotesLineEndsAndTheByteOrderMark) {
  const auto table = parse_csv("\xEF\xBB\xBFid,text\r\n1,\"a, \"\"b\"\"\nc\"\n\n2,\n", "t.csv");
  ASSERT_TRUE(table) << table.error().message.text();
  EXPECT_EQ(table->columns, (std::vector<std::string>{"id", "text"}));
  ASSERT_EQ(table->rows.size(), 2U);
  EXPECT_EQ(table->rows[0].cells[1], "a, \"b\"\nc");
  EXPECT_EQ(table->rows[0].line, 2U);
  EXPECT_EQ(table->rows[1].line, 5U);
  EXPECT_EQ(table->rows[1].cells[1], "");
  EXPECT_EQ(table->column("text"), 1U);
  EXPECT_EQ(table->column("none"), 2U);
}

TEST(Csv, ThatIsBrokenIsRefusedWithItsLine) {
  const std::pair<const char*, const char*> rows[] = {
      {"a,b\n1\n", "t.csv:2: 1 cells, but the header names 2 columns"},
      {"a,b\n1,2,3\n", "t.csv:2: 3 cells, but the header names 2 columns"},
      {"a\n1\n\"open\n", "t.csv:3: a quote is opened here and never closed"},
      {"a,a\n", "t.csv:1: column 'a' appears twice"},
      {"", "t.csv:1: the file is empty; a line with column names is expected"}};
  for (const auto& row : rows) {
    const auto table = parse_csv(row.first, "t.csv");
    ASSERT_FALSE(table) << row.first;
    EXPECT_EQ(table.error().message.text(), row.second);
    EXPECT_EQ(table.error().code, Errc::file);
  }
}

TEST(NumberText, IsWhatPeopleWrite) {
  EXPECT_EQ(number_text(1'310'720), "1310720");
  EXPECT_EQ(number_text(-2'147'483'648.), "-2147483648");
  EXPECT_EQ(number_text(9.99985), "10");
  EXPECT_EQ(number_text(28.6478898), "28.648");
  EXPECT_EQ(number_text(5'898'239.997), "5898240");
  EXPECT_EQ(number_text(0.0001234567), "0.0001235");
  EXPECT_EQ(number_text(-0.), "0");
  EXPECT_EQ(number_text(-0.5), "-0.5");
  EXPECT_EQ(number_text(1e18), "1e+18");
}

TEST(PlainNumber, HasNoExponentAndItsWholePartInFull) {
  EXPECT_EQ(plain_number(1'310'720, 6), "1310720");
  EXPECT_EQ(plain_number(9.99985, 6), "9.99985");
  EXPECT_EQ(plain_number(0.00001, 6), "0.00001");
  EXPECT_EQ(plain_number(1'310'727.4, 6), "1310727");
  EXPECT_EQ(plain_number(-0., 6), "0");
}

TEST(NumberText, TellsTwoNumbersApartThatAreNotTheSame) {
  EXPECT_EQ(told_apart(300.0001, 300), std::pair(std::string("300.0001"), std::string("300")));
  EXPECT_EQ(told_apart(60, 60), std::pair(std::string("60"), std::string("60")));
  EXPECT_EQ(told_apart(10, 9.5), std::pair(std::string("10"), std::string("9.5")));
}

class FileTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }
  // Tests run at the same time, each in a folder of its own.
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() /
      (std::string("servoctl-file-") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(FileTest, IsReplacedAsAWholeAndLeavesNothingBehind) {
  const auto path = folder / "f";
  ASSERT_TRUE(write_file_atomically(path, "one"));
  ASSERT_TRUE(write_file_atomically(path, "two"));
  EXPECT_EQ(read_file(path).value(), "two");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST_F(FileTest, ThatCannotBeReplacedStaysAsItIs) {
  const auto path = folder / "f";
  std::filesystem::create_directories(path /
                                      "full");  // A folder with something in it cannot be replaced by a file.
  const auto written = write_file_atomically(path, "x");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Errc::file);
  EXPECT_TRUE(std::filesystem::is_directory(path / "full"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  EXPECT_FALSE(write_file_atomically(folder / "none/f", "x"));
}

TEST_F(FileTest, ThatIsMissingOrTooLargeIsAnError) {
  EXPECT_EQ(read_file(folder / "none").error().code, Errc::file);
  ASSERT_TRUE(write_file_atomically(folder / "f", "12345"));
  EXPECT_FALSE(read_file(folder / "f", 4));
  EXPECT_TRUE(read_file(folder / "f", 5));
}

}  // namespace
}  // namespace servoctl
