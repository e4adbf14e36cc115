#include "drive/fault.hpp"

#include <gtest/gtest.h>

namespace servoctl::drive {
namespace {

constexpr std::string_view kHeader =
    "code,extra,panel,kind,resettable,name,name_zh,check,check_zh,assumed,line\n";

TEST(Faults, AreReadWithTheirUnknownsLeftOpen) {
  const auto faults =
      parse_faults(std::string(kHeader) +
                       "0x8130,,AL.09,fault,yes,Heartbeat lost,心跳超时,\"cable, master\",,,820\n"
                       ",,AL.28,warning,,Software limit,软件限位,,,code,5796\n",
                   "f.csv");
  ASSERT_TRUE(faults) << faults.error().message.text();
  ASSERT_EQ(faults->size(), 2U);
  EXPECT_EQ((*faults)[0].code, 0x8130);
  EXPECT_EQ((*faults)[0].resettable, true);
  EXPECT_EQ((*faults)[0].check, "cable, master");
  EXPECT_EQ((*faults)[1].code, std::nullopt);
  EXPECT_EQ((*faults)[1].kind, Fault::Kind::warning);
  EXPECT_EQ((*faults)[1].resettable, std::nullopt);
  EXPECT_EQ((*faults)[1].line, 5796U);
}

void expect_refused(std::string_view row, std::string_view message) {
  const auto faults = parse_faults(std::string(kHeader) + std::string(row), "f.csv");
  ASSERT_FALSE(faults) << row;
  EXPECT_EQ(faults.error().code, Errc::file);
  EXPECT_EQ(faults.error().message.text(), message);
}

TEST(Faults, WithABadCellAreRefusedWithLineAndColumn) {
  expect_refused("0x18130,,,fault,,N,,,,,1\n",
                 "f.csv:2: column 'code': '0x18130' is not a hexadecimal code of 16 bits, such as 0x8130");
  expect_refused("0x8130,,,oops,,N,,,,,1\n",
                 "f.csv:2: column 'kind': 'oops' is not fault, warning or status");
  expect_refused("0x8130,,,fault,maybe,N,,,,,1\n",
                 "f.csv:2: column 'resettable': 'maybe' is not yes, no or empty");
  expect_refused("0x8130,,,fault,,,,,,,1\n", "f.csv:2: column 'name': '' is not a name");
  expect_refused("0x8130,,,fault,,N,,,,,x\n", "f.csv:2: column 'line': 'x' is not a line number");
}

TEST(Faults, ACodeOfBareDigitsMayBeDecimalOrHexadecimal) {
  const auto bare = parse_faults("code,name\n2310,N\n", "f.csv");
  ASSERT_FALSE(bare);
  EXPECT_EQ(bare.error().message,
            "f.csv:2: column 'code': '2310' is not a hexadecimal code of 16 bits, such as 0x8130");
  EXPECT_EQ(bare.error().hint, "write 0x2310 if these digits are hexadecimal, 0x0906 if they are decimal");
  EXPECT_EQ(parse_faults("code,name\n12816,N\n", "f.csv").error().hint, "") << "more digits than a code has";
  const auto marked = parse_faults("code,name\n2310h,N\n0x3210,O\n", "f.csv");
  ASSERT_TRUE(marked) << marked.error().message.text();
  EXPECT_EQ(marked->front().code, 0x2310);
}

TEST(Faults, OneFaultIsInOneRow) {
  const auto twice =
      parse_faults("code,extra,panel,name\n0x2310,,Er01,A\n0x2310,1,Er01,B\n2310h,,Er01,C\n", "f.csv");
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().message, "f.csv:4: Er01 is in line 2 as well");
  EXPECT_TRUE(parse_faults("code,panel,name\n,,A\n,,B\n", "f.csv")) << "nothing tells them";
}

TEST(Faults, WithAnUnknownColumnAreRefused) { EXPECT_FALSE(parse_faults("code,colour\n1,red\n", "f.csv")); }

}  // namespace
}  // namespace servoctl::drive
