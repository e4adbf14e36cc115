// What the families do differently, each by its manual.
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class FamilyTest : public CellTest {
 protected:
  void boot(std::string_view spec) {
    build(spec);
    commission(cell_);
    ASSERT_EQ(next(100ms), "701#00");
  }
  /// The answer to a request; emergencies on the way are kept.
  std::string sdo(std::string_view frame) {
    auto answer = ask(frame);
    for (; answer.substr(0, 4) == "081#"; answer = next()) emergency = answer;
    return answer;
  }
  void enable() {
    for (const auto* word : {"06", "07", "0F"})
      ASSERT_EQ(ask(std::string("601#2B406000") + word + "000000").substr(0, 12), "581#60406000");
  }
  bool enabled() {
    const auto answer = ask("601#4041600000000000");
    return (std::stoul(answer.substr(12, 2), nullptr, 16) & 0x6FU) == 0x27U;
  }
  std::string emergency;
};

TEST_F(FamilyTest, Da200AnswersAWrongLengthByAbortAndAlarm) {
  boot("da200@1");
  EXPECT_EQ(sdo("601#2340600006000000"), "581#8040600010000706");  // 6040h has 2 bytes (1086).
  EXPECT_EQ(emergency, "081#01FF811A03000000");  // Er26-3: bytes 3 and 4 are 26 and 3 (336).
}

TEST_F(FamilyTest, Da200AlarmsWhatMayNotBeWritten) {
  boot("da200@1");
  EXPECT_EQ(sdo("601#2B41600001000000"), "581#8041600002000106");
  EXPECT_EQ(emergency.substr(10, 4), "1A05");  // Er26-5
}

TEST_F(FamilyTest, Da200AlarmsAccessToWhatItDoesNotHave) {  // 1084, 1085, 1163, 1164
  struct Access {
    std::string_view request;
    std::string_view answer;
    std::string_view alarm;
  };
  constexpr Access kAccesses[] = {
      {"601#403F600000000000", "581#803F600000000206", "081#01FF811A01000000"},  // Er26-1
      {"601#2B3F600001000000", "581#803F600000000206", "081#01FF811A01000000"},
      {"601#4018100700000000", "581#8018100711000906", "081#01FF811A02000000"},  // Er26-2
      {"601#2318100700000000", "581#8018100711000906", "081#01FF811A02000000"},
  };
  boot("da200@1");
  for (const auto& access : kAccesses) {
    emergency.clear();
    EXPECT_EQ(sdo(access.request), access.answer);
    EXPECT_EQ(emergency, access.alarm);
    EXPECT_EQ(std::stoul(sdo("601#4041600000000000").substr(12, 2), nullptr, 16) & 0x08U, 0x08U) << "fault";
  }
}

TEST_F(FamilyTest, Da200ChangesMappingOutsideOperationalOnly) {
  boot("da200@1");
  EXPECT_EQ(ask("601#2F00160000000000"), "581#6000160000000000");
  send("000#0101");
  EXPECT_EQ(sdo("601#2F00160000000000"), "581#8000160022000008");
  EXPECT_EQ(emergency.substr(10, 4), "1A08");  // Er26-8 (1091)
}

TEST_F(FamilyTest, Da200KeepsItsCobIdsAndKnowsNoType255) {
  boot("da200@1");
  EXPECT_EQ(sdo("601#2301140102030000").substr(0, 6), "581#80");
  EXPECT_EQ(sdo("601#2300180181010080"), "581#6000180100000000");  // Only bit 31 changes.
  EXPECT_EQ(sdo("601#2F001802FF000000").substr(0, 6), "581#80");
}

TEST_F(FamilyTest, Da200MapsAtMostFourObjects) {
  boot("da200@1");
  EXPECT_EQ(ask("601#2F02160000000000"), "581#6002160000000000");
  EXPECT_EQ(sdo("601#2F02160005000000").substr(0, 6), "581#80");
}

TEST_F(FamilyTest, Da200IsDisabledWhenItLeavesOperational) {
  boot("da200@1");
  send("000#0101");
  enable();
  EXPECT_TRUE(enabled());
  send("000#8001");  // 147
  EXPECT_FALSE(enabled());
}

TEST_F(FamilyTest, OthersStayEnabledWhenTheyLeaveOperational) {
  boot("dm@1");
  send("000#0101");
  enable();
  send("000#8001");
  EXPECT_TRUE(enabled());
}

TEST_F(FamilyTest, TsEchoesTheDataOfAWrite) {
  boot("ts@1");
  EXPECT_EQ(ask("601#2B332000C8000000"), "581#60332000C8000000");  // 36, 37
}

TEST_F(FamilyTest, TsSendsEmergenciesOfTwoBytes) {
  boot("ts@1");
  drive().raise_fault(0x160C, {}, bus.now());
  EXPECT_EQ(next(100ms), "081#0C16");
  EXPECT_EQ(ask("601#4012300000000000"), "581#4B1230000C160000");  // Dn_12 (1467, 2205)
}

TEST_F(FamilyTest, TsTellsALimitSwitchAndStaysWithoutFault) {
  boot("ts@1");
  drive().raise_fault(0x8681, {}, bus.now());
  send("601#4041600000000000");
  EXPECT_EQ(next(), "081#8186");
  EXPECT_EQ(next(), "581#4B41600050000000");
}

TEST_F(FamilyTest, TsWearsItsFlashUnlessItIsToldToUseTheRam) {
  boot("ts@1");
  (void)ask("601#2B33200064000000");
  EXPECT_EQ(drive().flash_writes(), 1U);
  (void)ask("601#2B99200001000000");  // Fn_99 = 1
  const auto before = drive().flash_writes();
  (void)ask("601#2B33200065000000");
  EXPECT_EQ(drive().flash_writes(), before);
  send("000#8101");
  EXPECT_EQ(next(200ms), "701#00");
  EXPECT_EQ(ask("601#4033200000000000"), "581#4B33200064000000");  // 443: what was in RAM is gone.
}

TEST_F(FamilyTest, TsRefusesALockedParameterUntilThePasswordIsThere) {
  boot("ts@1");
  EXPECT_EQ(ask("601#2B00200014000000"), "581#8000200021000008");
  EXPECT_EQ(ask("601#2B3F200094260000").substr(0, 12), "581#603F2000");  // 9876 (57)
  EXPECT_EQ(ask("601#2B00200014000000").substr(0, 12), "581#60002000");
}

TEST_F(FamilyTest, TsMapsByCountAndLeavesTheCobIdAlone) {
  boot("ts@1");
  for (const auto* line :
       {"601#2F00160000000000", "601#2300160110004060", "601#2F00160001000000"})  // 1727-1729
    EXPECT_EQ(ask(line).substr(0, 6), "581#60") << line;
  EXPECT_EQ(ask("601#2300160110004060").substr(0, 6), "581#80") << "the count is not 0";
}

TEST_F(FamilyTest, DmTakesItsOwnModesAndNoOthers) {
  boot("dm@1");
  for (const auto* mode : {"01", "03", "06"})
    EXPECT_EQ(ask(std::string("601#2B606000") + mode + "000000").substr(0, 6), "581#60") << mode;
  EXPECT_EQ(ask("601#2B60600008000000").substr(0, 6), "581#80");
}

TEST_F(FamilyTest, DmHoldsFloatsInIntegers) {
  boot("dm@1");
  EXPECT_EQ(ask("601#4002200400000000"), "581#430220040000F042");  // 120.0 (926)
}

TEST_F(FamilyTest, DmRefusesToChangeAMappingOfAValidPdo) {
  boot("dm@1");
  EXPECT_EQ(ask("601#2F00160000000000").substr(0, 6), "581#80");
  EXPECT_EQ(ask("601#2300140101020080").substr(0, 6), "581#60");
  EXPECT_EQ(ask("601#2F00160000000000").substr(0, 6), "581#60");
}

TEST_F(FamilyTest, Sv2KeepsItsFixedPdos) {
  boot("sv2@1");
  EXPECT_EQ(ask("601#2F01170000000000"), "581#8001170002000106");
  EXPECT_EQ(ask("601#4001170100000000").substr(0, 6), "581#43");
}

TEST_F(FamilyTest, Sv2ClearsAFaultByItsOwnObjectAndOnlyWhereItCanBeCleared) {
  boot("sv2@1");
  drive().raise_fault(0x8611, {}, bus.now());
  EXPECT_EQ(next(), "081#1186210000000000");
  EXPECT_EQ(next(100ms), "");
  EXPECT_EQ(sdo("601#2B05200101000000"), "581#6005200100000000");
  EXPECT_EQ(sdo("601#403F600000000000"), "581#4B3F600000000000");
  drive().raise_fault(0x2220, {}, bus.now());  // Err-12, not to be cleared (1405).
  (void)next(100ms);
  (void)next(100ms);
  (void)sdo("601#2B05200101000000");
  EXPECT_EQ(sdo("601#403F600000000000"), "581#4B3F600020220000");
}

TEST_F(FamilyTest, Sv2KeepsWhatIsWrittenUnlessTheEepromIsSwitchedOff) {
  boot("sv2@1");
  (void)ask("601#2B01200164000000");
  EXPECT_EQ(drive().flash_writes(), 1U);
  (void)ask("601#2B05200300000000");
  const auto before = drive().flash_writes();
  (void)ask("601#2B01200165000000");
  EXPECT_EQ(drive().flash_writes(), before);
}

TEST_F(FamilyTest, Gsd600ChangesOnlyBitThirtyOneOfItsCobIdsAndMapsInvalidPdos) {
  boot("gsd600@1");
  EXPECT_EQ(ask("601#2301140101020000").substr(0, 6), "581#80");  // 1511
  EXPECT_EQ(ask("601#2F00160000000000").substr(0, 6), "581#80");  // 1549
  EXPECT_EQ(ask("601#2300140101020080").substr(0, 6), "581#60");
  EXPECT_EQ(ask("601#2F00160000000000").substr(0, 6), "581#60");
}

}  // namespace
}  // namespace servoctl::sim
