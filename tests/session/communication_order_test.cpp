// Writes to communication objects in an order that a server of CiA 301 takes.
#include "session/communication_order.hpp"

#include <gtest/gtest.h>

namespace servoctl::session {
namespace {

using Steps = std::vector<std::string>;

Steps told(const Values& present, const Values& wanted) {
  Steps out;
  for (const auto& write : plan_writes(nullptr, present, wanted))
    out.push_back(to_string(write.object) + "=" + to_hex(write.data, ""));
  return out;
}

Bytes u32(std::uint32_t value) { return store_le(value, 4); }

TEST(CommunicationOrder, TheSyncCounterIsWrittenWhileThePeriodIsZero) {
  const auto values = [](std::uint32_t period, std::uint8_t overflow) {
    return Values{{{0x1006, 0}, u32(period)}, {{0x1017, 0}, {0, 0}}, {{0x1019, 0}, {overflow}}};
  };
  EXPECT_EQ(told(values(1000, 0), values(2000, 10)),
            (Steps{"0x1006:0=00000000", "0x1019:0=0A", "0x1006:0=D0070000"}));
  EXPECT_EQ(told(values(1000, 0), values(1000, 10)),
            (Steps{"0x1006:0=00000000", "0x1019:0=0A", "0x1006:0=E8030000"}));
  EXPECT_EQ(told(values(0, 0), values(1000, 10)), (Steps{"0x1019:0=0A", "0x1006:0=E8030000"}));
  EXPECT_EQ(told(values(1000, 0), values(0, 10)), (Steps{"0x1006:0=00000000", "0x1019:0=0A"}));
  EXPECT_EQ(told(values(1000, 10), values(2000, 10)), (Steps{"0x1006:0=D0070000"}));
}

TEST(CommunicationOrder, TheCounterAloneIsWrittenWhereThePeriodIsNotKnown) {
  EXPECT_EQ(told({{{0x1019, 0}, {0}}}, {{{0x1019, 0}, {10}}}), Steps{"0x1019:0=0A"});
}

TEST(CommunicationOrder, AHeartbeatIsWatchedByOneEntryAtATime) {
  const Values present{
      {{0x1016, 1}, u32(0x0005'01F4)}, {{0x1016, 2}, u32(0x0006'01F4)}, {{0x1016, 3}, u32(0)}};
  auto wanted = present;
  std::swap(wanted[{0x1016, 1}], wanted[{0x1016, 2}]);
  EXPECT_EQ(told(present, wanted),
            (Steps{"0x1016:1=00000000", "0x1016:2=00000000", "0x1016:1=F4010600", "0x1016:2=F4010500"}));
  wanted = present;
  wanted[{0x1016, 2}] = u32(0x0007'01F4);
  wanted[{0x1016, 3}] = u32(0x0006'01F4);
  EXPECT_EQ(told(present, wanted), (Steps{"0x1016:2=00000000", "0x1016:2=F4010700", "0x1016:3=F4010600"}));
  wanted = present;
  wanted[{0x1016, 3}] = u32(0x0007'01F4);
  EXPECT_EQ(told(present, wanted), Steps{"0x1016:3=F4010700"});
}

TEST(CommunicationOrder, ACobIdInUseIsSwitchedOffBeforeItChanges) {
  EXPECT_EQ(told({{{0x1014, 0}, u32(0x81)}}, {{{0x1014, 0}, u32(0x82)}}),
            (Steps{"0x1014:0=81000080", "0x1014:0=82000000"}));
  EXPECT_EQ(told({{{0x1014, 0}, u32(0x8000'0081)}}, {{{0x1014, 0}, u32(0x82)}}), Steps{"0x1014:0=82000000"});
  EXPECT_EQ(told({{{0x1014, 0}, u32(0x81)}}, {{{0x1014, 0}, u32(0x8000'0081)}}), Steps{"0x1014:0=81000080"});
  EXPECT_EQ(told({{{0x1012, 0}, u32(0x8000'0100)}}, {{{0x1012, 0}, u32(0x8000'0200)}}),
            (Steps{"0x1012:0=00010000", "0x1012:0=00020080"}));
  EXPECT_EQ(told({{{0x1012, 0}, u32(0x100)}}, {{{0x1012, 0}, u32(0x200)}}), Steps{"0x1012:0=00020000"});
  EXPECT_EQ(told({{{0x1005, 0}, u32(0x4000'0080)}}, {{{0x1005, 0}, u32(0x4000'0081)}}),
            (Steps{"0x1005:0=80000000", "0x1005:0=81000040"}));
  EXPECT_EQ(told({{{0x1005, 0}, u32(0x80)}}, {{{0x1005, 0}, u32(0x81)}}), Steps{"0x1005:0=81000000"});
}

Steps told(const Values& wanted) {
  Steps out;
  for (const auto& write : plan_writes_for_any_drive(wanted))
    out.push_back(to_string(write.object) + "=" + to_hex(write.data, ""));
  return out;
}

TEST(ForAnyDrive, NobodyIsWatchedBeforeTheFirstEntryIsWritten) {
  EXPECT_EQ(told({{{0x1016, 1}, u32(0)}, {{0x1016, 2}, u32(0x0005'01F4)}, {{0x1017, 0}, {0, 0}}}),
            (Steps{"0x1016:1=00000000", "0x1016:2=00000000", "0x1016:2=F4010500", "0x1017:0=0000"}));
  EXPECT_EQ(told({{{0x1016, 1}, u32(0)}, {{0x1016, 2}, u32(0)}}),
            (Steps{"0x1016:1=00000000", "0x1016:2=00000000"}));
}

TEST(ForAnyDrive, TheSyncCounterIsWrittenWhileThePeriodIsZero) {
  EXPECT_EQ(told({{{0x1006, 0}, u32(1000)}, {{0x1019, 0}, {10}}}),
            (Steps{"0x1006:0=00000000", "0x1019:0=0A", "0x1006:0=E8030000"}));
  EXPECT_EQ(told({{{0x1006, 0}, u32(0)}, {{0x1019, 0}, {10}}}), (Steps{"0x1006:0=00000000", "0x1019:0=0A"}));
  EXPECT_EQ(told({{{0x1019, 0}, {10}}}), Steps{"0x1019:0=0A"}) << "no period is known to be put back";
  EXPECT_EQ(told({{{0x1006, 0}, u32(1000)}}), Steps{"0x1006:0=E8030000"});
}

TEST(ForAnyDrive, CobIdsAreSwitchedOffFirst) {
  EXPECT_EQ(told({{{0x1005, 0}, u32(0x80)}, {{0x1012, 0}, u32(0x8000'0100)}, {{0x1014, 0}, u32(0x81)}}),
            (Steps{"0x1012:0=00010000", "0x1014:0=81000080", "0x1005:0=80000000", "0x1012:0=00010080",
                   "0x1014:0=81000000"}));
  EXPECT_EQ(told({{{0x1005, 0}, u32(0x4000'0080)}, {{0x1014, 0}, u32(0x8000'0081)}}),
            (Steps{"0x1005:0=80000000", "0x1005:0=80000040", "0x1014:0=81000080"}));
}

TEST(ForAnyDrive, AllPdosAreInvalidBeforeTheFirstChanges) {
  const Values wanted{{{0x1400, 1}, u32(0x201)},
                      {{0x1400, 2}, {255}},
                      {{0x1600, 0}, {1}},
                      {{0x1600, 1}, u32(0x6040'0010)},
                      {{0x1600, 2}, u32(0x6060'0008)},
                      {{0x1800, 1}, u32(0xC000'0181)},
                      {{0x1800, 2}, {1}}};
  EXPECT_EQ(told(wanted), (Steps{"0x1400:1=01020080", "0x1800:1=810100C0", "0x1600:0=00", "0x1600:1=10004060",
                                 "0x1600:0=01", "0x1400:2=FF", "0x1800:2=01", "0x1400:1=01020000"}));
}

TEST(CommunicationOrder, ParametersComeBeforeAndHeartbeatsBehind) {
  const Values present{{{0x1006, 0}, u32(0)}, {{0x1017, 0}, {0, 0}}, {{0x2000, 0}, {0}}};
  const Values wanted{{{0x1006, 0}, u32(1000)}, {{0x1017, 0}, {1, 0}}, {{0x2000, 0}, {1}}};
  EXPECT_EQ(told(present, wanted), (Steps{"0x2000:0=01", "0x1006:0=E8030000", "0x1017:0=0100"}));
}

}  // namespace
}  // namespace servoctl::session
