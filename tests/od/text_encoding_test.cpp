#include "od/text_encoding.hpp"

#include "tests/od/eds_support.hpp"
#include "tests/od/guarded_text.hpp"

namespace servoctl::od {
namespace {

/// What it is taken for; no byte behind it may be looked at.
TextEncoding guess(std::string_view bytes) { return guess_encoding(GuardedText(bytes).text()); }

std::string around(const char* before, int byte, const char* after) { return before + bytes({byte}) + after; }

TEST(Utf8, HasTheFormsOfItsDefinition) {
  for (const auto& character :
       {bytes({0xC2, 0x80}), bytes({0xDF, 0xBF}), bytes({0xE0, 0xA0, 0x80}), bytes({0xE1, 0x80, 0x80}),
        bytes({0xED, 0x9F, 0xBF}), bytes({0xEE, 0x80, 0x80}), bytes({0xEF, 0xBF, 0xBF}),
        bytes({0xF0, 0x90, 0x80, 0x80}), bytes({0xF1, 0x80, 0x80, 0x80}), bytes({0xF4, 0x8F, 0xBF, 0xBF})}) {
    EXPECT_EQ(guess(character), TextEncoding::utf8) << character;
    EXPECT_EQ(guess("a" + character + character + "b"), TextEncoding::utf8) << character;
    for (std::size_t cut = 1; cut < character.size(); ++cut) {
      EXPECT_NE(guess(character.substr(0, cut)), TextEncoding::utf8) << character << cut;
      EXPECT_NE(guess(character.substr(0, cut) + "  "), TextEncoding::utf8) << character << cut;
      for (const int wrong : {0x7F, 0xC0}) {
        auto broken = character;
        broken[cut] = static_cast<char>(wrong);
        EXPECT_NE(guess(broken), TextEncoding::utf8) << character << cut;
      }
    }
  }
  for (const auto& none :
       {bytes({0x80}), bytes({0xBF, 0x80}), bytes({0xC1, 0xBF}), bytes({0xE0, 0x9F, 0xBF}),
        bytes({0xED, 0xA0, 0x80}), bytes({0xF0, 0x8F, 0xBF, 0xBF}), bytes({0xF4, 0x90, 0x80, 0x80}),
        bytes({0xF5, 0x80, 0x80, 0x80}), bytes({0xFF, 0x80, 0x80, 0x80})})
    EXPECT_NE(guess(none), TextEncoding::utf8) << none;
}

TEST(Utf16, WithoutAMarkHasItsNulsOnOneSide) {
  const auto nuls_at = [](std::size_t size, std::size_t count, std::size_t side) {
    std::string text(size, 'x');
    for (std::size_t i = 0; i < count; ++i) text[2 * i + side] = '\0';
    return text;
  };
  EXPECT_EQ(guess(nuls_at(10, 2, 1)), TextEncoding::utf8);
  EXPECT_EQ(guess(nuls_at(10, 3, 1)), TextEncoding::utf16le);
  EXPECT_EQ(guess(nuls_at(10, 3, 0)), TextEncoding::utf16be);
  auto mixed = nuls_at(60, 20, 1);
  mixed[58] = '\0';
  EXPECT_EQ(guess(mixed), TextEncoding::utf8);
  mixed[41] = '\0';
  EXPECT_EQ(guess(mixed), TextEncoding::utf16le);
}

TEST(Gbk, HasTheLettersOfGb2312) {
  const auto second_pair = [](int lead, int trail) { return guess(bytes({0xCB, 0xD9, lead, trail})); };
  for (const int lead : {0xA1, 0xA3, 0xB0, 0xF7})
    EXPECT_EQ(second_pair(lead, 0xD6), TextEncoding::gbk) << lead;
  for (const int lead : {0xA0, 0xA2, 0xA4, 0xAF, 0xF8})
    EXPECT_EQ(second_pair(lead, 0xD6), TextEncoding::cp1252) << lead;
  for (const int trail : {0xA1, 0xFE}) EXPECT_EQ(second_pair(0xB3, trail), TextEncoding::gbk) << trail;
  for (const int trail : {0xA0, 0xB3, 0xFF})
    EXPECT_EQ(second_pair(0xB3, trail), TextEncoding::cp1252) << trail;
  EXPECT_EQ(guess(bytes({0xCB, 0xD9})), TextEncoding::cp1252);
  EXPECT_EQ(guess(bytes({0x80, 0xCB, 0xD9, 0xB6, 0xC8})), TextEncoding::gbk);
}

TEST(Gbk, IsWhatMostBytesMustBe) {
  const auto chinese = bytes({0xCB, 0xD9, 0xB6, 0xC8});
  EXPECT_EQ(guess(chinese + bytes({0x20, 0xFF, 0xFF, 0xFF})), TextEncoding::gbk);
  EXPECT_EQ(guess(chinese + bytes({0x20, 0xFF, 0xFF, 0xFF, 0xFF})), TextEncoding::cp1252);
  EXPECT_EQ(guess("a" + bytes({0xFF, 0xFF, 0xFF}) + "b" + chinese), TextEncoding::gbk);
}

TEST(Gbk, EndsWhereTheTextDoes) {
  const auto text = bytes({0xCB, 0xD9, 0xB6, 0xC8, 0xFF, 0xFF, 0xFF, 0xFF});
  EXPECT_EQ(guess_encoding(std::string_view(text).substr(0, 7)), TextEncoding::gbk);
}

TEST(Cp850, HasLettersWhereCp1252HasDashesAndQuotes) {
  for (int byte = 0x80; byte <= 0xFF; ++byte) {
    const bool dash = byte == 0x91 || byte == 0x92 || byte == 0x93 || (byte >= 0x95 && byte <= 0x97);
    const auto in_word = byte < 0xA0 && !dash ? TextEncoding::cp850 : TextEncoding::cp1252;
    EXPECT_EQ(guess(around("A", byte, "")), in_word) << byte;
    EXPECT_EQ(guess(around("", byte, "z")), in_word) << byte;
    EXPECT_EQ(guess(around("a", byte, "Z")), in_word) << byte;
    EXPECT_EQ(guess(around(" ", byte, " ")), byte == 0xF8 ? TextEncoding::cp850 : TextEncoding::cp1252)
        << byte;
  }
  for (const auto* letter : {"A", "Z", "a", "z"}) {
    EXPECT_EQ(guess(around(letter, 0x81, "")), TextEncoding::cp850) << letter;
    EXPECT_EQ(guess(around("", 0x81, letter)), TextEncoding::cp850) << letter;
  }
  for (const auto* outside : {"@", "[", "`", "{"})
    EXPECT_EQ(guess(around(outside, 0x81, outside)), TextEncoding::cp1252) << outside;
}

TEST(Cp850, HasTheDegreeWhereCp1252HasALetter) {
  EXPECT_EQ(guess(around("25", 0xF8, "C")), TextEncoding::cp850);
  EXPECT_EQ(guess(around("", 0xF8, "C")), TextEncoding::cp850);
  EXPECT_EQ(guess(around("25", 0xF8, "")), TextEncoding::cp850);
  EXPECT_EQ(guess(around("25", 0xF8, "B")), TextEncoding::cp1252);
  EXPECT_EQ(guess(around("x", 0xF8, "C")), TextEncoding::cp1252);
}

TEST(Cp850, IsWhatMoreLettersMustBe) {
  EXPECT_EQ(guess(bytes({'a', 0x81, 0xE9, ' ', 0x20})), TextEncoding::cp1252);
  EXPECT_EQ(guess(bytes({'a', 0x81, 0x81, 'a', ' ', 0xE9})), TextEncoding::cp850);
  EXPECT_EQ(guess(bytes({'a', 0x81, 'a', ' ', 0xE9, ' ', 0xE9})), TextEncoding::cp1252);
}

TEST(DecodedText, TellsWhereItsFirstForeignByteIs) {
  for (std::size_t before = 0; before < 40; ++before) {
    const auto text = std::string(before, 'x') + "\xE9 \xE9" + std::string(40 - before, 'y');
    const auto decoded = to_utf8(GuardedText(text).text());
    EXPECT_EQ(decoded.line, 1U);
    EXPECT_EQ(decoded.column, before + 1);
    EXPECT_EQ(to_utf8("\n" + text).line, 2U);
    EXPECT_EQ(to_utf8("\n" + text).column, before + 1);
    EXPECT_EQ(to_utf8("ab\n" + text).column, before + 1);
  }
}

TEST(DecodedText, WritesBytesWithoutMeaningOut) {
  const auto single = to_utf8(bytes({'c', 0x9D, 'x', ' ', 0xE9, 0x9D}));
  EXPECT_EQ(single.text(""), "c\\x9Dx é\\x9D");
  EXPECT_EQ(single.odd_bytes, 2U);
  const auto lone_surrogate = to_utf8(bytes({0xFF, 0xFE, 'a', 0, 0x00, 0xDC, 'b', 0, 'c', 0, 'd'}));
  EXPECT_EQ(lone_surrogate.text(""), "a\\x00\\xDCbc\\x64");
  EXPECT_EQ(lone_surrogate.odd_bytes, 3U);
  const auto big = to_utf8(bytes({0xFE, 0xFF, 0, 'a', 0xDC, 0x00, 0, 'b'}));
  EXPECT_EQ(big.text(""), "a\\xDC\\x00b");
}

TEST(DecodedText, OfAnyLengthIsWhole) {
  std::string text;
  std::string expected;
  for (int i = 0; i < 40'000; ++i) {
    text += i % 7 == 0 ? "\xE9 " : "ab";
    expected += i % 7 == 0 ? "é " : "ab";
  }
  const auto decoded = to_utf8(text);
  EXPECT_EQ(decoded.text(text), expected);
  EXPECT_EQ(decoded.odd_bytes, 0U);
}

TEST(DecodedText, IsTheFilesOwnWhereNothingIsChanged) {
  const std::string_view marked = "\xEF\xBB\xBFGröße";
  const auto decoded = to_utf8(marked);
  EXPECT_TRUE(decoded.own_bytes);
  EXPECT_EQ(decoded.text(marked).data(), marked.data() + 3);
  EXPECT_EQ(decoded.text(marked), "Größe");
  EXPECT_EQ(to_utf8(std::string_view("long a\0long b\0c", 15)).skipped_nuls, 2U);
}

TEST(Encoding, HasTheNamesOfIconv) {
  const std::pair<TextEncoding, const char*> rows[] = {
      {TextEncoding::utf8, "UTF-8"},       {TextEncoding::utf16le, "UTF-16LE"},
      {TextEncoding::utf16be, "UTF-16BE"}, {TextEncoding::gbk, "GBK"},
      {TextEncoding::cp1252, "CP1252"},    {TextEncoding::cp850, "CP850"},
      {TextEncoding::cp932, "CP932"},      {TextEncoding::cp950, "CP950"},
      {TextEncoding::cp1251, "CP1251"}};
  for (const auto& row : rows) EXPECT_EQ(name(row.first), row.second);
  EXPECT_EQ(title(TextEncoding::cp932), "Shift-JIS (CP932)");
  EXPECT_EQ(title(TextEncoding::cp950), "Big5 (CP950)");
  EXPECT_EQ(title(TextEncoding::gbk), "GBK");
}

TEST(Binary, IsWhatHasMoreThanOneControlCharacterInTwenty) {
  for (int byte = 0; byte < 0x100; ++byte) {
    const bool of_text = byte >= ' ' || (byte >= 9 && byte <= 13 && byte != 11) || byte == 0 || byte == 0x1A;
    EXPECT_EQ(is_binary(bytes({byte})), !of_text) << byte;
  }
  EXPECT_FALSE(is_binary(std::string(19, 'x') + "\x01"));
  EXPECT_TRUE(is_binary(std::string(18, 'x') + "\x01"));
  EXPECT_FALSE(is_binary(""));
}

TEST(Binary, IsToldByTheFirst16KiB) {
  EXPECT_FALSE(
      is_binary(std::string(819, '\x01') + std::string(16384 - 819, 'x') + std::string(999, '\x01')));
  EXPECT_TRUE(is_binary(std::string(820, '\x01') + std::string(16384 - 820, 'x') + std::string(999, 'x')));
}

}  // namespace
}  // namespace servoctl::od
