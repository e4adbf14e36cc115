#include "od/data_type.hpp"

#include <gtest/gtest.h>

#include <map>

#include "od/complex_type.hpp"

namespace servoctl::od {
namespace {

struct DataTypeRow {
  DataType type;
  const char* name;
  std::uint16_t code;
  std::size_t size;  // 0: varies.
  char kind;         // Signed, unsigned, real or other.
};

/// CiA 301, table 44.
constexpr DataTypeRow kTable[] = {
    {DataType::boolean, "bool", 0x01, 1, 'u'},  {DataType::i8, "i8", 0x02, 1, 's'},
    {DataType::i16, "i16", 0x03, 2, 's'},       {DataType::i32, "i32", 0x04, 4, 's'},
    {DataType::u8, "u8", 0x05, 1, 'u'},         {DataType::u16, "u16", 0x06, 2, 'u'},
    {DataType::u32, "u32", 0x07, 4, 'u'},       {DataType::f32, "f32", 0x08, 4, 'r'},
    {DataType::string, "string", 0x09, 0, 'o'}, {DataType::bytes, "bytes", 0x0A, 0, 'o'},
    {DataType::time, "time", 0x0C, 6, 'o'},     {DataType::domain, "domain", 0x0F, 0, 'o'},
    {DataType::i24, "i24", 0x10, 3, 's'},       {DataType::f64, "f64", 0x11, 8, 'r'},
    {DataType::i40, "i40", 0x12, 5, 's'},       {DataType::i48, "i48", 0x13, 6, 's'},
    {DataType::i56, "i56", 0x14, 7, 's'},       {DataType::i64, "i64", 0x15, 8, 's'},
    {DataType::u24, "u24", 0x16, 3, 'u'},       {DataType::u40, "u40", 0x18, 5, 'u'},
    {DataType::u48, "u48", 0x19, 6, 'u'},       {DataType::u56, "u56", 0x1A, 7, 'u'},
    {DataType::u64, "u64", 0x1B, 8, 'u'}};

TEST(DataTypeTable, IsThatOfCia301) {
  for (const auto& row : kTable) {
    EXPECT_EQ(name(row.type), row.name);
    EXPECT_EQ(parse_data_type(row.name), row.type) << row.name;
    EXPECT_EQ(cia_code(row.type), row.code) << row.name;
    EXPECT_EQ(size_of(row.type), row.size == 0 ? std::nullopt : std::optional(row.size)) << row.name;
    EXPECT_EQ(is_signed(row.type), row.kind == 's') << row.name;
    EXPECT_EQ(is_unsigned(row.type), row.kind == 'u') << row.name;
    EXPECT_EQ(is_integer(row.type), row.kind == 's' || row.kind == 'u') << row.name;
    EXPECT_EQ(is_real(row.type), row.kind == 'r') << row.name;
  }
  EXPECT_EQ(parse_data_type("u9"), std::nullopt);
}

TEST(DataTypeTable, HasNoOtherCodes) {
  std::map<std::uint64_t, DataType> expected{{0x0B, DataType::string}, {0x0D, DataType::time}};
  for (const auto& row : kTable) expected[row.code] = row.type;
  for (std::uint64_t code = 0; code < 0x300; ++code) {
    // Records of CiA 301, types of the manufacturer and of device profiles.
    const bool complex = (code >= 0x20 && code <= 0x25) || (code >= 0x40 && code <= 0x25F);
    EXPECT_EQ(is_complex_type(code), complex) << code;
    if (complex) expected[code] = DataType::domain;
    const auto known = expected.find(code);
    EXPECT_EQ(data_type_from_cia(code), known == expected.end() ? std::nullopt : std::optional(known->second))
        << code;
  }
  EXPECT_EQ(data_type_from_cia(0x1'0000'0007), std::nullopt);
  EXPECT_EQ(cia_name(0x20), "PDO_COMMUNICATION_PARAMETER");
  EXPECT_EQ(cia_name(0x23), "IDENTITY");
  EXPECT_EQ(cia_name(0x40), "type of the manufacturer");
  EXPECT_EQ(cia_name(0x80), "type of the device profile");
}

TEST(DataTypes, HaveTheNamesOfCia309AsWell) {
  for (const auto& [theirs, ours] : std::map<const char*, DataType>{{"b", DataType::boolean},
                                                                    {"r32", DataType::f32},
                                                                    {"r64", DataType::f64},
                                                                    {"vs", DataType::string},
                                                                    {"os", DataType::bytes},
                                                                    {"us", DataType::string},
                                                                    {"d", DataType::domain},
                                                                    {"t", DataType::time},
                                                                    {"td", DataType::time},
                                                                    {"i16", DataType::i16},
                                                                    {"u32", DataType::u32}})
    EXPECT_EQ(parse_data_type(theirs), ours) << theirs;
  EXPECT_FALSE(parse_data_type("r16"));
}

}  // namespace
}  // namespace servoctl::od
