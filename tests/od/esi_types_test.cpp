#include <gtest/gtest.h>

#include "od/esi_types.hpp"
#include "od/esi_unit.hpp"
#include "tests/od/esi_support.hpp"

using namespace servoctl;
using namespace servoctl::od;

TEST(EsiTypes, BaseTypesHaveTheirNamesOfEtg1020AndOfCia301) {
  EXPECT_EQ(esi_base_type("UDINT")->type, DataType::u32);
  EXPECT_EQ(esi_base_type("LREAL")->type, DataType::f64);
  EXPECT_EQ(esi_base_type("INTEGER16")->type, DataType::i16);
  EXPECT_EQ(esi_base_type("bool")->bits, 1U);
  EXPECT_EQ(esi_base_type("STRING(10)")->type, DataType::string);
  EXPECT_EQ(esi_base_type("STRING(10)")->bits, 80U);
  EXPECT_EQ(esi_base_type("ARRAY [0..511] OF BYTE")->type, DataType::bytes);
  EXPECT_EQ(esi_base_type("ARRAY [0..511] OF BYTE")->bits, 4096U);
  for (const auto* name :
       {"", "DT2000", "BIT0", "BIT17", "STRING(", "STRING(x)", "ARRAY [3..1] OF BYTE", "ARRAY OF BYTE"})
    EXPECT_FALSE(esi_base_type(name)) << name;
}

TEST(EsiTypes, BitsAreANumberWithItsOwnHighest) {
  const auto type = esi_base_type("BIT3");
  ASSERT_TRUE(type);
  EXPECT_EQ(type->type, DataType::u8);
  EXPECT_EQ(type->bits, 3U);
  EXPECT_EQ(std::get<std::uint64_t>(type->high->value), 7U);
}

TEST(EsiTypes, NumbersOfSdoInformationBeyondCia301AreKnown) {
  EXPECT_EQ(esi_base_type(std::uint16_t{0x30})->type, DataType::boolean);
  EXPECT_EQ(esi_base_type(std::uint16_t{0x37})->bits, 8U);
  EXPECT_EQ(esi_base_type(std::uint16_t{0x1E})->type, DataType::u8);
  EXPECT_FALSE(esi_base_type(std::uint16_t{0x800}));
}

TEST(EsiTypes, ATypeDefinedByItselfIsNone) {
  const auto file = read_good(esi_objects(esi_object("#x2000", "A") + esi_object("#x2001", "UINT"),
                                          "<DataType><Name>A</Name><BaseType>B</BaseType></DataType>"
                                          "<DataType><Name>B</Name><BaseType>A</BaseType></DataType>"));
  EXPECT_EQ(file.sheet.dictionary.object(0x2000), nullptr);
  ASSERT_NE(finding(file, "unknown-data-type"), nullptr);
  EXPECT_EQ(finding(file, "unknown-data-type")->section, "Object #x2000");
}

TEST(EsiTypes, AStructureThatContainsItselfEndsThere) {
  const auto file =
      read_good(esi_objects(esi_object("#x2000", "A") + esi_object("#x2001", "UINT"),
                            "<DataType><Name>A</Name><SubItem><SubIdx>1</SubIdx><Name>x</Name><Type>A</Type>"
                            "</SubItem></DataType>"));
  EXPECT_EQ(file.sheet.dictionary.object(0x2000), nullptr);
}

TEST(EsiTypes, SubIndicesBeyond255AreTold) {
  const auto file = read_good(esi_objects(
      esi_object("#x2000", "A") + esi_object("#x2001", "UINT"),
      "<DataType><Name>ARR</Name><BaseType>UINT</BaseType><ArrayInfo><LBound>1</LBound><Elements>256</Elements>"
      "</ArrayInfo></DataType><DataType><Name>A</Name><SubItem><SubIdx>0</SubIdx><Name>n</Name><Type>USINT</Type>"
      "</SubItem><SubItem><Name>Elements</Name><Type>ARR</Type></SubItem></DataType>"));
  ASSERT_NE(finding(file, "sub-index-range"), nullptr);
  EXPECT_EQ(file.sheet.dictionary.object(0x2000)->entries.size(), 1U);
}

TEST(EsiTypes, ASubIndexThatStandsTwiceIsToldAndTheFirstUsed) {
  const auto file = read_good(esi_objects(
      esi_object("#x2000", "A"),
      "<DataType><Name>A</Name><SubItem><SubIdx>1</SubIdx><Name>x</Name><Type>UINT</Type></SubItem>"
      "<SubItem><SubIdx>1</SubIdx><Name>y</Name><Type>SINT</Type></SubItem></DataType>"));
  EXPECT_NE(finding(file, "duplicate-sub-index"), nullptr);
  EXPECT_EQ(file.sheet.dictionary.find({0x2000, 1})->type, DataType::u16);
}

TEST(EsiTypes, WhatIsWrongInATypeIsToldOnceHoweverManyObjectsHaveIt) {
  std::string objects;
  for (int i = 0; i < 9; ++i) objects += esi_object("#x200" + std::to_string(i), "A");
  const auto file = read_good(esi_objects(
      objects + esi_object("#x3000", "UINT"),
      "<DataType><Name>A</Name><SubItem><SubIdx>999</SubIdx><Name>x</Name><Type>UINT</Type></SubItem></DataType>"));
  EXPECT_EQ(std::count_if(file.sheet.diagnostics.begin(), file.sheet.diagnostics.end(),
                          [](const Diagnostic& d) { return d.rule == "bad-number"; }),
            1);
}

TEST(EsiTypes, ObjectsOfHugeTypesStopAtALimit) {
  std::string objects;
  for (int i = 0; i < 1000; ++i) objects += esi_object(std::to_string(0x2000 + i), "A");
  const auto file = read_good(esi_objects(
      objects,
      "<DataType><Name>A</Name><BaseType>UINT</BaseType><ArrayInfo><LBound>0</LBound><Elements>256</Elements></ArrayInfo></DataType>"));
  EXPECT_LE(file.sheet.dictionary.entry_count(), 100'000U);
  EXPECT_NE(finding(file, "too-many-entries"), nullptr);
}

TEST(EsiUnit, NumbersOfCia303AreUnits) {
  EXPECT_EQ(esi_unit("#x00B44700")->unit, "rpm");
  EXPECT_EQ(esi_unit("#xFD030000")->unit, "ms");
  EXPECT_EQ(esi_unit("#xFF260000")->unit, "V");
  EXPECT_DOUBLE_EQ(esi_unit("#xFF260000")->scale, 0.1);
  EXPECT_EQ(esi_unit("#x00B55700")->unit, "inc/s2");
  EXPECT_EQ(esi_unit("mm")->unit, "mm");
  EXPECT_FALSE(esi_unit("#x00FE0000")) << "a unit that is not known is none";
  EXPECT_FALSE(esi_unit("0"));
  EXPECT_FALSE(esi_unit(""));
}
