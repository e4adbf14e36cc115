// Tables of faults as people have them.
#include <gtest/gtest.h>

#include "base/format.hpp"
#include "foreign_sheet.hpp"

namespace servoctl::drive {
namespace {

/// The table of the family; an error otherwise.
std::string faults_of(std::string_view csv) {
  const auto out = convert_fault_table(csv);
  EXPECT_EQ(out.wrong(), "") << csv;
  return out.table.csv;
}

TEST(ForeignFaults, FaultsOfAnyKind) {
  std::vector<Error> errors;
  const auto table = convert_faults(
      "Fault code,Display,Name,Cause,Remedy,Reset\n2310h,Er01,Overcurrent,Short,Check,Y\nE05,,Encoder,,,\n0x8611,,"
      "Following,,,no\n",
      "f.csv", errors);
  ASSERT_TRUE(errors.empty()) << errors.front().message.text();
  EXPECT_EQ(table.csv,
            "code,extra,panel,kind,resettable,name,name_zh,check,check_zh\n"
            "0x2310,,Er01,,yes,Overcurrent,,Short; Check,\n"
            ",,E05,,,Encoder,,,\n"
            "0x8611,,,,no,Following,,,\n");
  (void)convert_faults("code,name,reset\n0x2310,A,maybe\n0x2311,,no\n", "f.csv", errors);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0].message.text(), "f.csv:2: column 'resettable': 'maybe' is not yes, no or empty");
  EXPECT_EQ(errors[1].message.text(), "f.csv:3: column 'name': '' is not a name");
}

TEST(ForeignFaults, BareDigitsAreNoCode) {
  const auto panel = convert_fault_table("故障码,名称\n2310,过流\n");
  EXPECT_NE(panel.table.csv.find("\n,,2310,,,过流"), std::string::npos) << panel.table.csv;
  EXPECT_EQ(
      panel.notices(),
      "f.csv:2: what column '故障码' has without 0x or h is taken as what the panel shows; codes of 603Fh "
      "are written 0x8611\n");
  for (const auto* heading : {"Error code (603Fh)", "EMCY code", "CANopen code"}) {
    const auto code = convert_fault_table(formatted("{},Name\n2310,A\n", heading));
    EXPECT_EQ(
        code.wrong(),
        "f.csv:2: column 'code': '2310' is not a hexadecimal code of 16 bits, such as 0x8130; write 0x2310 if these "
        "digits are hexadecimal, 0x0906 if they are decimal\n")
        << heading;
  }
  EXPECT_NE(convert_fault_table("EMCY code,Name\nEr01,A\n")
                .wrong()
                .find("f.csv:2: column 'code': 'Er01' is not a hex"),
            std::string::npos);
  EXPECT_NE(convert_fault_table("Error code (dec),Name\n8976,A\n").wrong().find("the base of numbers"),
            std::string::npos);
  EXPECT_NE(
      convert_fault_table("Code,Display,Name\n2310,Er01,A\n").wrong().find("'2310' is no code of 603Fh"),
      std::string::npos);
}

TEST(ForeignFaults, WhatMayBeACodeOrAPanelTextIsNamed) {
  const auto refused = [](std::string_view csv, std::string_view what) {
    const auto wrong = convert_fault_table(csv).wrong();
    EXPECT_NE(wrong.find(what), std::string::npos) << csv << "\ngave: " << wrong;
  };
  refused(
      "Error code,Name\n0x2310 / 0x2311,A\n",
      "f.csv:2: '0x2310 / 0x2311' may be a code of 603Fh or what the panel shows; write one code in a row");
  refused("Error code,Name\n0x2310,A\n23A0,B\n", "f.csv:3: '23A0' may be a code of 603Fh or what the panel");
  refused("No,Code,Name\n1,0x2310,A\n2,0x3220,B\n",
          "f.csv:1: the column 'No' counts the rows: 1, 2, 3; remove it; name it 'panel'");
  refused("Panel,Name\nEr01,A\nEr02,B\nEr01,C\n", "f.csv:4: Er01 is in line 2 as well; write all causes");
  EXPECT_NE(faults_of("Panel,Code,Name\n1,0x2310,A\n2,0x3220,B\n").find("0x2310,,1,"), std::string::npos);
  (void)faults_of("Panel,Name\n,A\n,B\n");
}

TEST(ForeignFaults, OnlyKnownWordsAreKinds) {
  for (const auto* text : {"非故障", "Warning (fault)", "报警"}) {
    const auto wrong = convert_fault_table(formatted("code,kind,name\n0x2310,{},A\n", text)).wrong();
    EXPECT_NE(wrong.find(formatted("f.csv:2: column 'kind': '{}' is not", text)), std::string::npos) << wrong;
  }
}

TEST(ForeignFaults, TheColumnOfCodesIsKnownByTheFormsPeoplePrint) {
  for (const auto* heading : {"603Fh", "603Fh code", "0x603F", "Code 603Fh", "Error code",
                              "Error code (603Fh)", "603Fh error code", "EMCY error code", "CAN error code",
                              "错误码", "故障码", "错误码（603Fh）", "603Fh错误码", "CANopen故障码"})
    EXPECT_NE(faults_of(formatted("{},Name\n2310h,A\n", heading)).find("\n0x2310,,,,,A"), std::string::npos)
        << heading;
}

TEST(ForeignFaults, BesideAColumnNamedFor603FhTheOtherIsWhatThePanelShows) {
  for (const auto* heads :
       {"Fault code,603Fh code", "故障码,错误码（603Fh）", "Error code,EMCY error code"}) {
    EXPECT_NE(faults_of(formatted("{},Name\nEr01,2310h,A\n", heads)).find("\n0x2310,,Er01,,,A"),
              std::string::npos)
        << heads;
  }
  const auto twice = convert_fault_table("603Fh,EMCY code,Name\n2310h,2310h,A\n").wrong();
  EXPECT_NE(twice.find("'603Fh' and 'EMCY code' are headings of one column, code"), std::string::npos)
      << twice;
}

}  // namespace
}  // namespace servoctl::drive
