// Shift-JIS, Big5 and CP1251, told from each other and from those of the other tests.
#include "od/text_encoding.hpp"
#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

struct Sample {
  const char* text;
  std::string written;
};

const Sample kJapanese[] = {
    {"速度指令", bytes({0x91, 0xAC, 0x93, 0x78, 0x8E, 0x77, 0x97, 0xDF})},
    {"モータ定格電流",
     bytes({0x83, 0x82, 0x81, 0x5B, 0x83, 0x5E, 0x92, 0xE8, 0x8A, 0x69, 0x93, 0x64, 0x97, 0xAC})},
    {"ソフトウェア", bytes({0x83, 0x5C, 0x83, 0x74, 0x83, 0x67, 0x83, 0x45, 0x83, 0x46, 0x83, 0x41})},
    {"位置偏差カウンタ",
     bytes({0x88, 0xCA, 0x92, 0x75, 0x95, 0xCE, 0x8D, 0xB7, 0x83, 0x4A, 0x83, 0x45, 0x83, 0x93, 0x83, 0x5E})},
    {"トルク制限値", bytes({0x83, 0x67, 0x83, 0x8B, 0x83, 0x4E, 0x90, 0xA7, 0x8C, 0xC0, 0x92, 0x6C})},
};

const Sample kTaiwanese[] = {
    {"速度命令", bytes({0xB3, 0x74, 0xAB, 0xD7, 0xA9, 0x52, 0xA5, 0x4F})},
    {"馬達額定電流", bytes({0xB0, 0xA8, 0xB9, 0x46, 0xC3, 0x42, 0xA9, 0x77, 0xB9, 0x71, 0xAC, 0x79})},
    {"位置誤差", bytes({0xA6, 0xEC, 0xB8, 0x6D, 0xBB, 0x7E, 0xAE, 0x74})},
    {"功能設定", bytes({0xA5, 0x5C, 0xAF, 0xE0, 0xB3, 0x5D, 0xA9, 0x77})},
    {"目標速度", bytes({0xA5, 0xD8, 0xBC, 0xD0, 0xB3, 0x74, 0xAB, 0xD7})},
};

const Sample kRussian[] = {
    {"Скорость", bytes({0xD1, 0xEA, 0xEE, 0xF0, 0xEE, 0xF1, 0xF2, 0xFC})},
    {"Ток двигателя", bytes({0xD2, 0xEE, 0xEA, 0x20, 0xE4, 0xE2, 0xE8, 0xE3, 0xE0, 0xF2, 0xE5, 0xEB, 0xFF})},
    {"Номинальная частота", bytes({0xCD, 0xEE, 0xEC, 0xE8, 0xED, 0xE0, 0xEB, 0xFC, 0xED, 0xE0, 0xFF, 0x20,
                                   0xF7, 0xE0, 0xF1, 0xF2, 0xEE, 0xF2, 0xE0})},
    {"Режим работы", bytes({0xD0, 0xE5, 0xE6, 0xE8, 0xEC, 0x20, 0xF0, 0xE0, 0xE1, 0xEE, 0xF2, 0xFB})},
};

template <std::size_t n>
void expect_all(const Sample (&samples)[n], TextEncoding encoding, const std::string& title) {
  for (const auto& sample : samples) {
    EXPECT_EQ(guess_encoding(sample.written), encoding) << sample.text;
    const auto file = read(variable("2000", "7", "Denotation=" + sample.written));
    ASSERT_EQ(file.notes.size(), 1U) << sample.text;
    EXPECT_EQ(file.notes[0].denotation, sample.text);
    EXPECT_EQ(findings(file), Rules{"5:12 encoding"}) << sample.text;
    EXPECT_EQ(file.diagnostics.front().message, "the file is taken as " + title);
  }
}

TEST(EdsEncoding, OfJapaneseIsShiftJis) { expect_all(kJapanese, TextEncoding::cp932, "Shift-JIS (CP932)"); }

TEST(EdsEncoding, OfTraditionalChineseIsBig5) { expect_all(kTaiwanese, TextEncoding::cp950, "Big5 (CP950)"); }

TEST(EdsEncoding, OfRussianIsCp1251) { expect_all(kRussian, TextEncoding::cp1251, "CP1251"); }

TEST(EdsEncoding, OfRussianInCapitalsIsCp1251WhereThereIsEnoughOfIt) {
  const auto capitals =
      bytes({0xD1, 0xCA, 0xCE, 0xD0, 0xCE, 0xD1, 0xD2, 0xDC, ' ', 0xC4, 0xC2, 0xC8, 0xC3, 0xC0});
  EXPECT_EQ(guess_encoding(capitals), TextEncoding::cp1251);
  EXPECT_NE(guess_encoding(capitals.substr(0, 4)), TextEncoding::cp1251);
}

TEST(EdsEncoding, WithABackslashAsSecondByteKeepsItsLine) {
  // The second byte of the first character is that of a backslash, of the second that of a bracket.
  const auto file = read(variable("2000", "7", "Denotation=" + bytes({0x83, 0x5C, 0x83, 0x5D, 0x83, 0x7B})));
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_EQ(file.notes[0].denotation, "\u30bd\u30be\u30dc");
}

TEST(EdsEncoding, ThatWasGuessedWronglyLosesNoByte) {
  // Random bytes in words: whatever they are taken for, each stands in the text or is written out.
  std::uint32_t state = 1;
  const auto next = [&] { return (state = state * 1664525 + 1013904223) >> 24U; };
  for (int round = 0; round < 2000; ++round) {
    std::string text = "a ";
    for (int i = 0; i < 12; ++i)
      text += static_cast<char>(next() % 4 == 0 ? ' ' + next() % 90 : 0x80 + next() % 128);
    const auto decoded = to_utf8(text);
    EXPECT_EQ(decoded.text(text).find("\xEF\xBF\xBD"), std::string_view::npos) << round;
    const auto taken = decoded.encoding;
    const bool strict =
        taken == TextEncoding::cp932 || taken == TextEncoding::cp950 || taken == TextEncoding::cp1251;
    EXPECT_TRUE(!strict || decoded.odd_bytes == 0) << round;
    std::size_t written_out = 0;
    for (auto at = decoded.buffer.find("\\x"); at != std::string::npos;
         at = decoded.buffer.find("\\x", at + 1))
      ++written_out;
    EXPECT_GE(written_out, decoded.odd_bytes) << round;
  }
}

TEST(Encoding, MeansSomethingInEveryByteOrNot) {
  EXPECT_TRUE(means_something(kJapanese[0].written, TextEncoding::cp932));
  EXPECT_FALSE(means_something(bytes({0x91}), TextEncoding::cp932));
  EXPECT_FALSE(means_something(bytes({0x98}), TextEncoding::cp1251));
}

}  // namespace
}  // namespace servoctl::od
