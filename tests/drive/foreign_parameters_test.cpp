// Tables of parameters as people have them.
#include <gtest/gtest.h>

#include "base/format.hpp"
#include "drive/foreign_table.hpp"
#include "foreign_sheet.hpp"
#include "od/parameter.hpp"

namespace servoctl::drive {
namespace {

std::string first_error(std::string_view csv) {
  const auto out = convert(csv);
  return out.errors.empty() ? std::string() : out.errors.front().message.text();
}

bool refuses(std::string_view csv, std::string_view message) {
  const auto wrong = convert(csv).wrong();
  if (wrong.find(message) != std::string::npos) return true;
  ADD_FAILURE() << csv << "\ngave: " << wrong;
  return false;
}

TEST(ForeignTables, ChineseHeadingsGbkAndSemicolonsAreRead) {
  // 编号;名称;单位;出厂值;范围;生效方式 / P1-01;增益;0.1Hz;40.0;0.1~200.0;立即生效 in GBK.
  const std::string_view gbk =
      "\xB1\xE0\xBA\xC5;\xC3\xFB\xB3\xC6;\xB5\xA5\xCE\xBB;\xB3\xF6\xB3\xA7\xD6\xB5;\xB7\xB6\xCE\xA7;"
      "\xC9\xFA\xD0\xA7\xB7\xBD\xCA\xBD\n"
      "P1-01;\xD4\xF6\xD2\xE6;0.1Hz;40.0;0.1~200.0;\xC1\xA2\xBC\xB4\xC9\xFA\xD0\xA7\n";
  std::vector<Error> errors;
  const auto table = convert_parameters(gbk, "t.csv", foreign_sheet().dictionary, errors);
  ASSERT_TRUE(errors.empty()) << errors.front().message.text();
  const auto parameters = od::parse_parameters(table.csv, "p.csv");
  ASSERT_TRUE(parameters) << parameters.error().message.text();
  ASSERT_EQ(parameters->size(), 1U);
  const auto& gain = parameters->front();
  EXPECT_EQ(gain.object, (ObjectAddress{0x2001, 0})) << "by the number in the name of the object";
  EXPECT_EQ(gain.name, "Speed gain");
  EXPECT_EQ(gain.name_zh, "增益");
  EXPECT_EQ(gain.unit, "Hz");
  EXPECT_EQ(gain.scale, 0.1);
  EXPECT_EQ(gain.default_value, od::Value(std::uint64_t{400})) << "40.0 Hz, and raw by the scale";
  EXPECT_EQ(gain.max, od::Value(std::uint64_t{2000}));
  EXPECT_EQ(gain.effect, od::Effect::immediate);
}

TEST(ForeignTables, RawNumbersStayRaw) {
  std::vector<Error> errors;
  const auto table = convert_parameters("No.,Index,Unit,Default,Min,Max\nP1-01,2001h,0.1Hz,400,1,2000\n",
                                        "t.csv", foreign_sheet().dictionary, errors);
  ASSERT_TRUE(errors.empty());
  EXPECT_TRUE(table.notices.empty());
  EXPECT_NE(table.csv.find("P1-01,0x2001:00,u16,rw,Hz,0.1,400,1,2000,"), std::string::npos) << table.csv;
}

TEST(ForeignTables, ADefaultThatTheDataSheetHasRawShowsTheUnit) {
  std::vector<Error> errors;
  const auto table =
      convert_parameters("No.,Unit,Default\nP1-01,0.1Hz,40\n", "t.csv", foreign_sheet().dictionary, errors);
  EXPECT_EQ(table.notices.size(), 1U);
  EXPECT_NE(table.csv.find(",Hz,0.1,400,"), std::string::npos) << table.csv;
}

TEST(ForeignTables, WhatIsNotUnderstoodIsNamedByItsLine) {
  EXPECT_EQ(
      first_error("Title\n\nNo.,Type,Default\nP1-01,u99,1\n"),
      "t.csv:4: column 'type': 'u99' is not a data type: bool, i8, i16, i24, i32, i64, u8, u16, u24, u32, u64, "
      "f32, f64, string, bytes, domain or time");
  EXPECT_EQ(first_error("No.,Default\nP1-01,abc\n"),
            "t.csv:2: column 'default': 'abc' is not a value of u16: 'abc' is not a number");
  EXPECT_EQ(first_error("No.,Range\nP1-01,many\n"), "t.csv:2: the range 'many' is not understood");
  EXPECT_EQ(first_error("No.,Index\nP1-01,2099h\n"),
            "t.csv:2: P1-01: object 0x2099:00 is not in the data sheet");
  EXPECT_EQ(first_error("nothing,known\n1,2\n"), "t.csv:1: no line with column headings was found");
  EXPECT_EQ(first_error("unit,default\n1,2\n"), "t.csv:1: no column has the parameter numbers");
  std::vector<Error> errors;
  const auto table = convert_parameters("No.,Unit,Colour\nBasic,,\nP1-01,ms,red\n", "t.csv",
                                        foreign_sheet().dictionary, errors);
  ASSERT_EQ(table.notices.size(), 2U);
  EXPECT_EQ(table.notices[0], "t.csv:2: left out: a line with its first cell alone");
  EXPECT_EQ(table.notices[1], "t.csv:1: column 'Colour' is not understood and left out");
}

TEST(ForeignTables, ASizeThatTheDataSheetContradictsIsNotWritten) {
  std::vector<Error> errors;
  const auto table =
      convert_parameters("No.,Type\nP1-01,UINT32\n", "t.csv", foreign_sheet().dictionary, errors);
  EXPECT_NE(table.csv.find("P1-01,0x2001:00,u16,"), std::string::npos) << table.csv;
  ASSERT_EQ(table.notices.size(), 1U);
}

TEST(ForeignTables, ASubIndexOfTwoDigitsIsNoGuess) {
  refuses("No.,Index,Sub\nP2,2004h,10\n",
          "t.csv:2: sub-index '10' may be decimal or hexadecimal; write 0x10 or 0x0A\n");
  refuses("No.,Index\nP2,2004.10\n", "t.csv:2: sub-index '10' may be decimal or hexadecimal");
  refuses("No.,Index\nP2,2004:10\n", "t.csv:2: sub-index '10' may be decimal or hexadecimal");
  refuses("No.,Index\nP2,2004h-10\n", "t.csv:2: sub-index '10' may be decimal or hexadecimal");
  refuses("No.,Index,Sub\nP2,,1\n", "t.csv:2: sub-index 1 without an index");
  refuses("No.,Index,Sub\nP1-01,2001h,sub2\n",
          "t.csv:2: column 'object': '2001h:sub2' is not an object such as");
  for (const auto* sub : {"0Ah", "0x0A", "0A"}) {
    const auto out = convert(formatted("No.,Index,Sub\nP2,2004h,{}\n", sub));
    EXPECT_EQ(out.wrong(), "") << sub;
    EXPECT_NE(out.table.csv.find("P2,0x2004:0A,"), std::string::npos) << sub;
  }
}

TEST(ForeignTables, AHeadingThatNamesABaseOrAUnitIsNotDropped) {
  for (const auto* heading : {"Index (dec)", "Sub (hex)", "子索引（十进制）", "Default (hex)", "Index hex"})
    refuses(formatted("No.,Name,{}\nP1-01,a,1\n", heading),
            formatted("t.csv:1: '{}': the base of numbers is not read from a heading; write hexadecimal",
                      heading));
  refuses("No.,Default (rpm)\nP1-01,1\n",
          "t.csv:1: 'Default (rpm)': text in brackets over numbers is not read");
  refuses(
      "No.,Default %\nP1-01,1\n",
      "t.csv:1: 'Default %': the mark % over numbers is not read; take it out of the heading; write units into "
      "a column 'unit'");
  refuses("No.,Max *\nP1-01,1\n", "t.csv:1: 'Max *': the mark * over numbers is not read");
  EXPECT_EQ(convert("No.,Name (short),Index (CANopen)\nP1-01,a,2001h\n").wrong(), "");
}

TEST(ForeignTables, OneNumberForTheResolverIsOneNumber) {
  refuses("No.,Index\nP1-01,2001h\nP1-1,2002h\n",
          "t.csv:3: P1-1 is the same parameter number as P1-01 in line 2; ");
}

TEST(ForeignTables, ANumberDoesNotHideAnObject) {
  refuses("id,Index\n2002,2001h\n", "t.csv:2: number '2002' is the address of object 0x2002:0; ");
  refuses("id,Index\nFilters,2001h\n", "t.csv:2: number 'Filters' is the name of object 0x2004:0; ");
  refuses("id,Index\n-P1,2001h\n", "t.csv:2: number '-P1' begins as an option does; ");
  refuses("id,Index\nALL,2001h\n", "t.csv:2: number 'ALL' is the word for all parameters; ");
  EXPECT_EQ(convert("Index,Name\n2001h,Gain\n").wrong(), "") << "its own address";
}

TEST(ForeignTables, AFactorIsSaidOnceAndClearly) {
  refuses("No.,Unit,Scale\nP1-02,0.1 Hz,0.01\n", "t.csv:2: the scale is 0.01, but the unit is '0.1 Hz'; ");
  EXPECT_EQ(convert("No.,Unit,Scale\nP1-02,0.1 Hz,0.1\n").wrong(), "");
  for (const auto* heading : {"Factor", "倍率", "Resolution", "小数位数"})
    refuses(formatted("No.,Name,{}\nP1-02,a,10\n", heading),
            formatted("t.csv:1: '{}' does not say whether raw numbers are multiplied or divided; name the "
                      "column 'scale' and write numbers for which value = raw × scale",
                      heading));
  for (const auto* unit : {"2^10", "10^-3 s", "1/100 Hz", "1e-3 s", "1e3", "×0.1 Hz", "\"0,1 Hz\"", "Hz/10",
                           "Hz × 10", "0.1*Hz", "0 Hz", "x0.1 Hz", "(0.1Hz)"})
    refuses(formatted("No.,Unit\nP1-02,{}\n", unit), "t.csv:2: the unit '");
}

TEST(ForeignTables, RawAndDisplayedNumbersDoNotMix) {
  refuses("No.,Index,Unit,Default\nP1-01,2001h,0.1 Hz,400\nP1-02,2002h,0.1 ms,20.5\n",
          "t.csv:3: default or limits are numbers in the unit here, but raw numbers in line 2; ");
  const auto open = convert("No.,Index,Unit,Default\nP1-02,2002h,0.1 ms,20\n");
  EXPECT_EQ(open.wrong(), "");
  EXPECT_EQ(
      open.notices(),
      "t.csv:2: default and limits are taken as raw numbers (value = raw × scale): no line of the table "
      "proves it; compare them with the manual\n");
  refuses("No.,Index,Unit,Default\nP1-02,2002h,0.1 ms,20.55\n",
          "t.csv:2: P1-02: 20.55 ms is no whole number of steps of 0.1; ");
  refuses("No.,Index,Unit,Default,Max\nP1-02,2002h,0.1 ms,20.5,1e30\n",
          "t.csv:2: P1-02: 1e30 ms is no whole number of steps of 0.1; ");
}

TEST(ForeignTables, AScaleThatTheDataSheetContradictsIsRefused) {
  refuses(
      "No.,Unit,Default\nP1-01,0.5 Hz,40.0\n",
      "t.csv:2: P1-01: default is 80 here and 400 in the data sheet (raw numbers, by the scale 0.5); correct the "
      "number or the scale, or leave the cell empty; the data sheet has 400, which is 200 Hz by this scale\n");
  refuses("No.,Unit,Max\nP1-01,0.01 Hz,200.0\n",
          "t.csv:2: P1-01: max is 20000 here and 2000 in the data sheet (raw numbers, by the scale 0.01); ");
  refuses("No.,Unit,Max\nP1-01,0.1 Hz,30.0\n",
          "t.csv:2: P1-01: the default 400 is above the maximum 300 (raw");
  refuses("No.,Unit,Default\nP1-01,0.1 Hz,50\n",
          "t.csv:2: P1-01: default is 50 here and 400 in the data sheet");
  EXPECT_EQ(convert("No.,Unit,Default,Range\nP1-01,0.1 Hz,40.0,0.5~150.0\n").wrong(), "")
      << "narrower limits";
}

TEST(ForeignTables, ALimitThatIsEqualByChanceProvesNothing) {
  const auto chance = convert("No.,Unit,Min\nP1-01,0.1 Hz,1\n");
  EXPECT_EQ(chance.wrong(), "");
  EXPECT_NE(chance.notices().find("no line of the table proves it"), std::string::npos) << chance.notices();
  const auto of_others = convert("No.,Index,Unit,Default\nP1-02,2002h,0.1 ms,20\nP1-01,2001h,0.1 Hz,400\n");
  EXPECT_EQ(of_others.wrong(), "");
  EXPECT_EQ(
      of_others.notices(),
      "t.csv:2: default and limits are taken as raw numbers (value = raw × scale), as line 3 shows them; compare "
      "them with the manual\n");
}

TEST(ForeignTables, HexadecimalNumbersAreRaw) {
  for (const auto* number : {"190h", "0x190"}) {
    const auto out = convert(formatted("No.,Unit,Default\nP1-01,0.1 Hz,{}\n", number));
    EXPECT_EQ(out.wrong() + out.notices(), "") << number;
    refuses(formatted("No.,Unit,Default,Range\nP1-01,0.1 Hz,{},1.0~200.0\n", number),
            "t.csv:2: default or limits are numbers in the unit here, but raw numbers in line 2; ");
  }
}

TEST(ForeignTables, ScaledRowsTakeRawNumbersOfTheDataSheet) {
  const auto out = convert("No.,Unit,Max\nP1-01,0.1 Hz,150.0\n");
  EXPECT_EQ(out.wrong(), "");
  EXPECT_NE(out.table.csv.find(",Hz,0.1,400,1,1500,"), std::string::npos) << out.table.csv;
}

TEST(ForeignTables, NoCellIsDropped) {
  refuses("No.,Index\nP1-01,2001h,7\n", "t.csv:2: 3 cells, 2 headings; ");
  refuses("No.,Index,\nP1-01,2001h,7\n", "t.csv:2: column 3 has no heading: '7'; ");
  refuses("No.,Default,出厂值\nP1-01,1,2\n",
          "t.csv:1: 'Default' and '出厂值' are headings of one column, default; keep one of the two columns");
  refuses("No.,Name,Enum\nP1-01,a,0=off\n,,1=on\n", "t.csv:3: a row without a parameter number; ");
  refuses("No.,Range,Max\nP1-01,0~5,9\n", "t.csv:2: max is 9, but the range is '0~5'; ");
  EXPECT_EQ(convert("No.,Index,,\nP1-01,2001h,,\n").wrong(), "") << "empty ones are nothing";
  const auto list = convert("No.,Index,Range\nP1-01,2001h,\"0: off, 1: on\"\n");
  EXPECT_NE(list.table.csv.find("0=off;1=on"), std::string::npos) << list.table.csv << list.wrong();
}

TEST(ForeignTables, OnlyKnownWordsAreEffects) {
  for (const auto* text : {"运行中不可更改", "非立即生效", "Not immediate", "unknown", "stop and restart"})
    refuses(formatted("No.,Effective\nP1-01,{}\n", text),
            formatted("t.csv:2: column 'effect': '{}' is not immediate, restart, standstill or empty", text));
}

TEST(ForeignTables, TheDataSheetDecidesTypeAndAccess) {
  const auto sign = convert("No.,Type\nP1-01,INT16\n");
  EXPECT_EQ(sign.notices(), "t.csv:2: P1-01 is i16 here and u16 in the data sheet: the data sheet is used\n");
  EXPECT_NE(sign.table.csv.find("P1-01,0x2001:00,u16,"), std::string::npos);
  const auto access = convert("No.,Access\nP1-03,R/W\n");
  EXPECT_EQ(access.notices(), "t.csv:2: P1-03 is rw here and ro in the data sheet: the data sheet is used\n");
  EXPECT_NE(access.table.csv.find("P1-03,0x2003:00,i16,ro,"), std::string::npos);
  for (const auto* word : {"ro", "wo"})
    EXPECT_EQ(
        convert(formatted("No.,Access\nP1-01,{}\n", word)).notices(),
        formatted("t.csv:2: P1-01 is {} here and rw in the data sheet: the data sheet is used\n", word));
  const auto wide = convert("No.,Default,Range\nP1-01,500,0~20000\n");
  EXPECT_EQ(wide.notices(),
            "t.csv:2: P1-01: default is 500 here and 400 in the data sheet: the table is used\n"
            "t.csv:2: P1-01: min is 0 here and 1 in the data sheet: the data sheet is used\n"
            "t.csv:2: P1-01: max is 20000 here and 2000 in the data sheet: the data sheet is used\n");
  EXPECT_NE(wide.table.csv.find(",500,1,2000,"), std::string::npos) << wide.table.csv;
}

TEST(ForeignTables, AnIndexAloneDoesNotNameAnEntry) {
  refuses("No.,Index\nP2,2004h\n",
          "t.csv:2: object 0x2004 has several entries, and no sub-index is given; write the sub-index");
  refuses("No.,Index,Default,Range\nP1-02,2002h,9,0~5\n",
          "t.csv:2: P1-02: the default 9 is above the maximum 5 (raw numbers); ");
}

TEST(ForeignTables, ANumberWithACommaIsNoGuess) {
  const std::string_view hint = "write decimals with a point and nothing between thousands: 0.5, 1000\n";
  refuses("No.;Unit;Default\nP1-01;0.1Hz;40,0\n",
          formatted("t.csv:2: '40,0' in column 'Default': a comma between digits is not read; {}", hint));
  refuses("No.;Unit;Range\nP1-01;0.1Hz;0,1~200,0\n", "t.csv:2: '0,1~200,0' in column 'Range': a comma");
  refuses("No.,Default\nP1-01,\"1,000\"\n", "t.csv:2: '1,000' in column 'Default': a comma");
  const auto out = convert("No.;Unit;Default\nP1-01;0.1Hz;40,0\n");
  EXPECT_EQ(out.errors.size(), 1U) << "one for the row: " << out.wrong();
  EXPECT_EQ(out.notices(), "") << "nothing is taken for anything";
}

TEST(ForeignTables, NumbersThatMayBeRawOrInTheUnitAreMarked) {
  const auto out = convert("No.,Index,Unit,Default,Min,Max\nP1-02,2002h,0.1 ms,20,0,300\n");
  EXPECT_NE(out.table.csv.find(",default;max,"), std::string::npos) << out.table.csv;
}

TEST(ForeignTables, AListThatMayBeAnotherOneIsNamed) {
  refuses("No.,Enum\nP1-01,0=off / 1=on\n",
          "t.csv:2: the list '0=off / 1=on' is not understood; write it as 0=off;1=on");
  const auto lines = convert("No.,Enum\nP1-01,\"0: off\n1: on\"\n");
  EXPECT_NE(lines.table.csv.find("0=off;1=on"), std::string::npos) << lines.table.csv << lines.wrong();
}

TEST(ForeignTables, WhatSpreadsheetsMakeOfATableIsNamed) {
  refuses("No.,Index\n2-Jan,2001h\n",
          "t.csv:2: '2-Jan' is a date or a rounded number, perhaps made of a parameter number");
  refuses("No.,Index\n2.00E+05,2001h\n", "t.csv:2: '2.00E+05' is a date or a rounded number");
  refuses(std::string_view("PK\x03\x04 No.,Index\n", 17),
          "t.csv is a spreadsheet, and no text; save the sheet");
  EXPECT_EQ(convert("No.,Index\nP1-01,2001h\nNo.,Index\nP1-02,2002h\n").table.rows, 2U)
      << "the headings again, as on each page of a manual";
}

TEST(ForeignTables, AColumnThatCountsIsNotTheNumbers) {
  refuses("No.,Code,Index\n1,P1-01,2001h\n2,P1-02,2002h\n",
          "t.csv:1: the column 'No.' counts the rows: 1, 2, 3; ");
  EXPECT_EQ(convert("id,Name,Index\n1,a,2001h\n2,b,2002h\n").wrong(), "");
}

TEST(ForeignTables, LinesMayEndAsInOldSpreadsheetsAndThereAreSome) {
  EXPECT_EQ(convert("No.,Index\rP1-01,2001h\r").table.rows, 1U);
  refuses("No.,Index\n", "t.csv:1: there are no rows below the headings");
}

TEST(ForeignTables, AParameterWithoutAnObjectIsNamed) {
  EXPECT_EQ(
      convert("No.,Name\nP1-01,a\nP9-99,b\nP9-98,c\n").notices(),
      "t.csv:3: parameters without an object, which the bus does not reach: 2, the first in this line\n");
}

}  // namespace
}  // namespace servoctl::drive
