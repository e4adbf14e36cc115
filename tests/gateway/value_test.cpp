// Values as CANopenNode (301/CO_fifo.c) and lely-core (src/co/val.c) read and write them; base64 by the
// vectors of RFC 4648, 10.
#include "gateway/value.hpp"

#include <gtest/gtest.h>

#include "base/base64.hpp"
#include "gateway/words.hpp"

namespace servoctl::gateway {
namespace {

/// The bytes of a value on the line in hexadecimal; `-` for one that is refused.
std::string bytes_of(std::string_view type, std::string_view words) {
  const auto parsed = parse_value(parse_value_type(type).value(), split_words(words).value());
  return parsed ? to_hex(*parsed) : "-";
}

std::string text_of(std::string_view type, std::string_view hex) {
  return value_text(parse_value_type(type).value(), parse_hex_bytes(hex).value());
}

TEST(GatewayValue, NumbersAreLittleEndianInADrive) {
  EXPECT_EQ(bytes_of("u16", "1000"), "E8 03");
  EXPECT_EQ(bytes_of("U32", "0x12345678"), "78 56 34 12");
  EXPECT_EQ(bytes_of("x16", "0x1234"), "34 12");
  EXPECT_EQ(bytes_of("i8", "-2"), "FE");
  EXPECT_EQ(bytes_of("i32", "-2"), "FE FF FF FF");
  EXPECT_EQ(bytes_of("u64", "0x0102030405060708"), "08 07 06 05 04 03 02 01");
  EXPECT_EQ(bytes_of("u24", "65537"), "01 00 01");
  EXPECT_EQ(bytes_of("b", "1"), "01");
  EXPECT_EQ(bytes_of("r32", "1.5"), "00 00 C0 3F");
  EXPECT_EQ(bytes_of("r64", "-2"), "00 00 00 00 00 00 00 C0");
}

TEST(GatewayValue, OutOfRangeAndNoNumberAreRefused) {
  EXPECT_EQ(bytes_of("u8", "256"), "-");
  EXPECT_EQ(bytes_of("u8", "-1"), "-");
  EXPECT_EQ(bytes_of("i8", "-129"), "-");
  EXPECT_EQ(bytes_of("u8", "64h"), "-");
  EXPECT_EQ(bytes_of("u8", "hex:01"), "-");
  EXPECT_EQ(bytes_of("b", "true"), "-");
  EXPECT_EQ(bytes_of("u8", "1 2"), "-");
  EXPECT_EQ(bytes_of("r32", "nan"), "-");
  EXPECT_EQ(bytes_of("u8", ""), "-");
  EXPECT_EQ(bytes_of("vs", R"("")"), "-") << "no write of CiA 309-3 has no bytes";
}

TEST(GatewayValue, AnswersAreWhatOtherStacksWrite) {
  EXPECT_EQ(text_of("u16", "E803"), "1000");
  EXPECT_EQ(text_of("i16", "FEFF"), "-2");
  EXPECT_EQ(text_of("x16", "3412"), "0x1234");
  EXPECT_EQ(text_of("x8", "0A"), "0x0A");
  EXPECT_EQ(text_of("b", "01"), "1");
  EXPECT_EQ(text_of("r32", "CDCCCC3D"), "0.1");
  EXPECT_EQ(text_of("r64", "000000000000F83F"), "1.5");
  EXPECT_EQ(text_of("hex", "0A1B"), "0A 1B");
  EXPECT_EQ(value_text({}, parse_hex_bytes("0A1B").value()), "0A 1B") << "no type is named";
  EXPECT_EQ(text_of("vs", "612262"), R"("a""b")");
  EXPECT_EQ(text_of("vs", "73616600"), R"("saf")") << "NUL ends no line";
  EXPECT_EQ(text_of("u16", "0A0B0C"), "0A 0B 0C") << "another length than the type has";
  EXPECT_EQ(text_of("t", "D2029649 0A00"), "10 160826066") << "28 bits of milliseconds";
}

TEST(GatewayValue, BytesAreHexOrBase64) {
  EXPECT_EQ(bytes_of("hex", "73 61 76 65"), "73 61 76 65");
  EXPECT_EQ(bytes_of("hex", "73617665"), "73 61 76 65");
  EXPECT_EQ(bytes_of("hex", "1 A 0b"), "01 0A 0B");
  EXPECT_EQ(bytes_of("hex", "123"), "-");
  EXPECT_EQ(bytes_of("d", "c2F2ZQ=="), "73 61 76 65");
  EXPECT_EQ(bytes_of("os", "c2F2ZQ"), "73 61 76 65");
  EXPECT_EQ(bytes_of("vs", R"("sa ve")"), "73 61 20 76 65");
  EXPECT_EQ(bytes_of("t", "10 160826066"), "D2 02 96 09 0A 00");
  EXPECT_EQ(bytes_of("td", "10"), "-");
  EXPECT_EQ(bytes_of("t", "65536 0"), "-");
  EXPECT_FALSE(parse_value_type("u7"));
}

TEST(GatewayBase64, IsThatOfTheRfc) {
  const std::pair<std::string_view, std::string_view> kVectors[] = {{"", ""},
                                                                    {"f", "Zg=="},
                                                                    {"fo", "Zm8="},
                                                                    {"foo", "Zm9v"},
                                                                    {"foob", "Zm9vYg=="},
                                                                    {"fooba", "Zm9vYmE="},
                                                                    {"foobar", "Zm9vYmFy"}};
  for (const auto& [text, coded] : kVectors) {
    const Bytes bytes(text.begin(), text.end());
    EXPECT_EQ(to_base64(bytes), coded);
    EXPECT_EQ(parse_base64(coded), bytes);
  }
  EXPECT_EQ(to_base64(Bytes{0xFB, 0xFF, 0xFE}), "+//+");
  for (const auto* wrong : {"Z", "Zg=", "Zm9v=", "Zm 9", "Zm9*", "====", "Zg==="})
    EXPECT_EQ(parse_base64(wrong), std::nullopt) << wrong;
}

}  // namespace
}  // namespace servoctl::gateway
