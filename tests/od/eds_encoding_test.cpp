#include "od/text_encoding.hpp"
#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

/// A file whose one name has these bytes.
std::string named(std::string_view name) {
  return "[2000]\r\nParameterName=" + std::string(name) + "\r\nDataType=7\r\nAccessType=ro\r\n";
}

std::string name_in(const EdsFile& file) {
  const auto* entry = file.dictionary.find({0x2000, 0});
  return entry == nullptr ? "none" : entry->name;
}

std::string utf16(std::string_view ascii, bool little) {
  std::string out;
  for (const char c : ascii) {
    if (!little) out += '\0';
    out += c;
    if (little) out += '\0';
  }
  return out;
}

TEST(EdsEncoding, OfUtf8IsTakenAsItIs) {
  for (const auto* mark : {"", "\xEF\xBB\xBF"}) {
    const auto file = read(mark + named("Größe 速度"));
    EXPECT_EQ(name_in(file), "Größe 速度");
    EXPECT_EQ(findings(file), Rules{});
  }
}

TEST(EdsEncoding, OfChineseIsGbk) {
  const auto file = read(named("\xCB\xD9\xB6\xC8 \xC4\xBF\xB1\xEA\xD6\xB5"));
  EXPECT_EQ(name_in(file), "速度 目标值");
  EXPECT_EQ(findings(file), Rules{"2:15 encoding"});
  EXPECT_EQ(file.diagnostics.front().message, "the file is taken as GBK");
}

TEST(EdsEncoding, OfWesternTextIsCp1252) {
  const std::pair<const char*, const char*> rows[] = {{"Gr\xF6\xDF"
                                                       "e \xFC"
                                                       "ber",
                                                       "Größe über"},
                                                      {"25 \xB0"
                                                       "C",
                                                       "25 °C"},
                                                      {"\x93quoted\x94 \x96 1 \xB5s", "“quoted” – 1 µs"},
                                                      {"Vitesse d\xE9sir\xE9"
                                                       "e",
                                                       "Vitesse désirée"}};
  for (const auto& row : rows) {
    const auto file = read(named(row.first));
    EXPECT_EQ(name_in(file), row.second);
    EXPECT_EQ(file.diagnostics.front().message, "the file is taken as CP1252");
  }
}

TEST(EdsEncoding, OfDosIsCp850) {
  const std::pair<const char*, const char*> rows[] = {{"Gr\x94\xE1"
                                                       "e f\x81r \x84u\xE1"
                                                       "ere",
                                                       "Größe für äußere"},
                                                      {"25 \xF8"
                                                       "C",
                                                       "25 °C"}};
  for (const auto& row : rows) {
    const auto file = read(named(row.first));
    EXPECT_EQ(name_in(file), row.second);
    EXPECT_EQ(file.diagnostics.front().message, "the file is taken as CP850");
  }
}

TEST(EdsEncoding, OfUtf16IsSeenWithAndWithoutAMark) {
  for (const bool little : {true, false})
    for (const bool marked : {true, false}) {
      const auto mark = marked ? std::string(little ? "\xFF\xFE" : "\xFE\xFF") : std::string();
      const auto file = read(mark + utf16(named("Speed"), little));
      EXPECT_EQ(name_in(file), "Speed");
      EXPECT_EQ(findings(file), Rules{"1:1 encoding"});
      EXPECT_EQ(file.dictionary.find({0x2000, 0})->line, 1U);
    }
}

TEST(EdsEncoding, WithBytesThatMeanNothingCountsThem) {
  const auto decoded = to_utf8("caf\xE9 \x9D");
  EXPECT_EQ(decoded.encoding, TextEncoding::cp1252);
  EXPECT_EQ(decoded.text(""), "café \\x9D");
  EXPECT_EQ(decoded.odd_bytes, 1U);
}

TEST(EdsEncoding, BrokenBehindAMarkOfUtf8IsMended) {
  const auto file = read("\xEF\xBB\xBF" + named("a\xFF"
                                                "b"));
  EXPECT_EQ(name_in(file),
            "a\\xFF"
            "b");
  EXPECT_EQ(findings(file), Rules{"2:16 encoding"});
}

TEST(EdsNul, IsSkippedWithAWarning) {
  auto text = named("Speed");
  text.insert(24, 2, '\0');
  text.insert(text.size(), 100, '\0');
  const auto file = read(text);
  EXPECT_EQ(name_in(file), "Speed");
  EXPECT_EQ(findings(file), Rules{"2:17 nul-byte"});
}

TEST(EdsEncoding, OfInvalidUtf8FormsIsNotUtf8) {
  for (const auto* text :
       {"\xC0\x80", "\xED\xA0\x80", "\xF5\x80\x80\x80", "\xE2\x82", "\xE0\x80\x80", "\x80"})
    EXPECT_NE(guess_encoding(text), TextEncoding::utf8) << text;
  for (const auto* text : {"\xC2\x80", "\xED\x9F\xBF", "\xF4\x8F\xBF\xBF", "\xE2\x82\xAC", ""})
    EXPECT_EQ(guess_encoding(text), TextEncoding::utf8) << text;
}

TEST(EdsEncoding, OfARuledCommentIsNotChinese) {
  EXPECT_NE(guess_encoding("; \xC4\xC4\xC4\xC4\xC4\xC4\xC4\xC4"), TextEncoding::gbk);
}

TEST(EdsEncoding, OfFewUmlautsInARowIsNotChinese) {
  EXPECT_EQ(guess_encoding("\xC4\xD6\xE4\xF6; f\xFCr gr\xF6\xDF"
                           "ere \xDC"
                           "berg\xE4nge"),
            TextEncoding::cp1252);
}

}  // namespace
}  // namespace servoctl::od
