// Numbers and values at the edge of what is taken.
#include "od/eds_value.hpp"
#include "tests/od/eds_support.hpp"

namespace servoctl::od {
namespace {

/// The default value of an entry of this type, or what is found wrong with it.
std::string value_of(std::string_view type, std::string_view text) {
  const auto file = read(variable("2000", type, "DefaultValue=" + std::string(text)));
  const auto& value = file.dictionary.find({0x2000, 0})->default_value;
  std::string out = value ? to_string(value->for_node(5)) : "none";
  for (const auto& finding : findings(file)) out += " " + finding;
  return out;
}

TEST(EdsNumber, WithALeadingZeroIsTold) {
  for (const auto* text : {"00", "01", "09", "0123"})
    EXPECT_EQ(value_of("7", text), std::to_string(std::stoi(text)) + " 5:14 leading-zero");
  for (const auto* text : {"0", "0x0", "00h", "00H", "10", "0b1"})
    EXPECT_EQ(findings(read(variable("2000", "7", "DefaultValue=" + std::string(text)))), Rules{}) << text;
  EXPECT_EQ(findings(read(variable("2000", "8", "DefaultValue=00.5"))), Rules{});
}

TEST(EdsNumber, ThatIsNoValueMayHaveALeadingZeroToo) {
  EXPECT_EQ(findings(read(variable("2000", "0007", ""))), Rules{"3:10 leading-zero"});
}

TEST(EdsNumber, ThatIsNoneIsShownInPart) {
  const auto file = read(variable("2000", "7", "DefaultValue=" + std::string(300, 'x')));
  EXPECT_EQ(file.diagnostics.front().message, "DefaultValue: '" + std::string(198, 'x') + "…");
}

TEST(EdsNumber, OfAnyLengthIsReadWhole) {
  const std::string zeros(200, '0');
  EXPECT_EQ(value_of("7", "0x" + zeros + "7"), "7");
  EXPECT_EQ(value_of("7", zeros + "7"), "7 5:14 leading-zero");
  EXPECT_EQ(value_of("0x11", "1" + zeros), "1e+200");
  EXPECT_EQ(value_of("0x11", "1" + zeros + "e-200"), "1");
  EXPECT_EQ(value_of("7", "1" + zeros), "none 5:14 bad-value");
}

TEST(EdsNumber, InTheComplementOfAWiderTypeIsToldShort) {
  for (const auto* text : {"0xFF80", "0xFFFFFF80", "0xFFFFFFFFFFFFFF80"})
    EXPECT_EQ(value_of("2", text), "-128 5:14 wide-value") << text;
  for (const auto* text : {"0xFF7F", "0x80FF", "-129", "200", "0x100"})
    EXPECT_EQ(value_of("2", text), "none 5:14 bad-value") << text;
  const auto file = read(variable("2000", "2", "DefaultValue=0x" + std::string(100, '0') + "FFFF"));
  EXPECT_EQ(file.diagnostics.front().message,
            "DefaultValue: 0x" + std::string(37, '0') + "… has more digits than i8; taken as -1");
  EXPECT_EQ(file.diagnostics.front().remedy, "write -1");
  EXPECT_EQ(value_of("5", "0xFFFFFFFF"), "none 5:14 bad-value");
}

TEST(EdsNumber, HasTheNodeIdOnEitherSide) {
  const std::pair<const char*, const char*> rows[] = {{"$NODEID", "5"},
                                                      {"$NODEID+", "5"},
                                                      {"$NODEID + 10", "15"},
                                                      {"10+$NODEID", "15"},
                                                      {"$NODEID+0x10", "21"},
                                                      {"$NODEID0x10", "21"},
                                                      {"0x10 $NODEID", "21"},
                                                      {"+$NODEID", "5"},
                                                      {"$NODE", "none 5:14 bad-value"},
                                                      {"$NODEID+x", "none 5:14 bad-value"},
                                                      {"$NODEID++5", "10"},
                                                      {"1$NODEID2", "none 5:14 bad-value"}};
  for (const auto& row : rows) EXPECT_EQ(value_of("7", row.first), row.second) << row.first;
  EXPECT_EQ(value_of("8", "$NODEID+1"), "none 5:14 bad-value");
  EXPECT_EQ(value_of("9", "$NODEID+1"), "$NODEID+1");
}

TEST(EdsNumber, OfARealMayBeItsBitsInAllDigits) {
  EXPECT_EQ(value_of("8", "1234567890"), "1234567890");
  EXPECT_EQ(value_of("8", "0X3F800000"), "1");
  EXPECT_EQ(value_of("0x11", "0x3FF0000000000000"), "1");
  EXPECT_EQ(value_of("0x11", "123456789012345678"), "1.2345678901234568e+17");
  EXPECT_EQ(value_of("8", "0x3F80000G"), "none 5:14 bad-value");
}

TEST(EdsNumber, OfATimeFits48Bits) {
  EXPECT_EQ(value_of("0xC", "65535 4294967295"), "FF FF FF FF FF FF");
  EXPECT_EQ(value_of("0xC", "1  0x10"), "10 00 00 00 01 00");
  EXPECT_EQ(value_of("0xC", "0xFFFFFFFFFFFF"), "FF FF FF FF FF FF");
  for (const auto* text : {"65536 0", "0 4294967296", "0x1000000000000", "-1", "-1 1", "1 -1", "x 1", "1 x"})
    EXPECT_EQ(value_of("0xC", text), "none 5:14 bad-value") << text;
}

TEST(EdsNumber, BehindACommentIsNone) {
  EXPECT_EQ(value_of("7", "5;6"), "5 5:14 trailing-comment");
  EXPECT_EQ(value_of("7", "5 # six"), "5 5:14 trailing-comment");
  EXPECT_EQ(value_of("7", ";5"), "none 5:14 trailing-comment");
  EXPECT_EQ(value_of("9", "a;b"), "a;b");
  EXPECT_EQ(value_of("0xA", "hex:01 02"), "01 02");
}

TEST(Shown, IsFortyColumnsOfAtMost160Bytes) {
  EXPECT_EQ(shown(std::string(40, 'x')), std::string(40, 'x'));
  EXPECT_EQ(shown(std::string(41, 'x')), std::string(39, 'x') + "…");
  std::string marks = "aa";
  for (int i = 0; i < 79; ++i) marks += "\u0301";
  EXPECT_EQ(shown(marks + "b"), marks);
  EXPECT_EQ(shown("a\tb"), "a\\tb");
}

}  // namespace
}  // namespace servoctl::od
