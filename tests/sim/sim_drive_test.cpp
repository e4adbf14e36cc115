// A simulated GSD600 against what its manual says; frames are written by hand, not by our client.
#include "sim_support.hpp"
#include "tests/source_dir.hpp"

#include <filesystem>
#include <fstream>

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class Gsd600 : public CellTest {
 protected:
  void SetUp() override {
    build("gsd600@1");
    ASSERT_EQ(next(), "701#00");
  }
};

TEST_F(Gsd600, AnswersTheExamplesOfItsManual) {
  EXPECT_EQ(ask("601#4061600000000000"), "581#4F61600001000000");
  EXPECT_EQ(ask("601#23FF6000E8030000"), "581#60FF600000000000");
  EXPECT_EQ(ask("601#40FF600000000000"), "581#43FF6000E8030000");
}

TEST_F(Gsd600, TakesExactLengthsOnly) {
  EXPECT_EQ(ask("601#2BFF6000E8030000"), "581#80FF600010000706");
  EXPECT_EQ(ask("601#2B60600003000000"), "581#8060600010000706");
  EXPECT_EQ(ask("601#2F60600003000000"), "581#6060600000000000");
}

TEST_F(Gsd600, RefusesSegmentedTransfers) {
  EXPECT_EQ(ask("601#21FF600004000000"), "581#80FF600001000405");
  EXPECT_EQ(ask("601#6000000000000000").substr(0, 6), "581#80");
}

TEST_F(Gsd600, RefusesWithTheAbortCodesOfItsManual) {
  EXPECT_EQ(ask("601#40FF5F0000000000"), "581#80FF5F0000000206");  // No such object.
  EXPECT_EQ(ask("601#4018100900000000"), "581#8018100911000906");  // No such sub-index.
  EXPECT_EQ(ask("601#2B41600001000000"), "581#8041600002000106");  // Read-only.
  EXPECT_EQ(ask("601#4003209B00000000"), "581#8003209B01000106");  // Pn0754 is write-only.
  EXPECT_EQ(ask("601#2F60600009000000"), "581#8060600030000906");  // Mode it does not have.
  EXPECT_EQ(ask("601#2B003200C8000000").substr(0, 6), "581#80");
}

TEST_F(Gsd600, KeepsValuesWithinTheLimitsOfItsTables) {
  EXPECT_EQ(ask("601#2B002032C8000000"), "581#8000203231000906");  // Pn0049 is 1..127.
  EXPECT_EQ(ask("601#2B00203200000000"), "581#8000203232000906");
}

TEST_F(Gsd600, ClearsTheErrorHistoryByZeroOnly) {
  EXPECT_EQ(ask("601#2F03100001000000"), "581#8003100030000906");
  EXPECT_EQ(ask("601#4003100100000000"), "581#8003100124000008");
  drive().raise_fault(0xFF00, {0x15, 0, 0, 0, 0}, bus.now());
  EXPECT_EQ(ask("601#4003100000000000").substr(0, 4), "081#");
  EXPECT_EQ(next(), "581#4F03100001000000");
  EXPECT_EQ(ask("601#4003100100000000"), "581#4303100100FF1500");
  EXPECT_EQ(ask("601#2F03100000000000"), "581#6003100000000000");
  EXPECT_EQ(ask("601#4003100000000000"), "581#4F03100000000000");
}

TEST_F(Gsd600, TellsAnAlarmOnceByEmergencyAndStatusword) {
  drive().raise_fault(0xFF00, {}, bus.now());
  send("601#4041600000000000");
  EXPECT_EQ(next(), "081#00FF810000000000");
  EXPECT_EQ(next(), "581#4B4160003F020000");
  EXPECT_EQ(next(50ms), "");
  EXPECT_EQ(ask("601#4041600000000000"), "581#4B41600038020000");
  EXPECT_EQ(ask("601#403F600000000000"), "581#4B3F600000FF0000");
}

TEST_F(Gsd600, ResetsAnAlarmOnlyWhenPn0032AllowedItAtTheLastStart) {
  drive().raise_fault(0xFF00, {}, bus.now());
  while (!next(50ms).empty()) {
  }
  EXPECT_EQ(ask("601#2B40600080000000"), "581#6040600000000000");
  EXPECT_EQ(ask("601#4041600000000000"), "581#4B41600038020000");
  EXPECT_EQ(ask("601#2B00202101000000"), "581#6000202100000000");
  send("000#8101");
  EXPECT_EQ(next(1s), "701#00");
  drive().raise_fault(0xFF00, {}, bus.now());
  while (!next(50ms).empty()) {
  }
  EXPECT_EQ(ask("601#2B40600080000000"), "081#0000000000000000");
  EXPECT_EQ(next(), "581#6040600000000000");
  EXPECT_EQ(ask("601#4041600000000000"), "581#4B41600070020000");
}

TEST_F(Gsd600, SendsHeartbeatsAfterItsTimeIsSet) {
  EXPECT_EQ(ask("601#2B17100064000000"), "581#6017100000000000");
  EXPECT_EQ(next(100ms), "701#7F");
  send("000#0101");
  EXPECT_EQ(next(), "181#7002");  // TPDO1, with which an operational drive begins.
  EXPECT_EQ(next(100ms), "701#05");
  send("000#0201");
  EXPECT_EQ(next(100ms), "701#04");
  EXPECT_EQ(ask("601#4041600000000000"), "");  // A stopped node answers no SDO.
}

TEST_F(Gsd600, ListensToCommandsForAllNodesAndIgnoresThoseForOthers) {
  send("000#0102");
  EXPECT_EQ(drive().nmt_state(), canopen::NmtState::pre_operational);
  send("000#0100");
  EXPECT_EQ(drive().nmt_state(), canopen::NmtState::operational);
}

TEST_F(Gsd600, TakesItsNodeIdFromPn0049AtTheNextStart) {
  EXPECT_EQ(ask("601#2B00203205000000"), "581#6000203200000000");
  EXPECT_EQ(ask("601#4041600000000000"), "581#4B41600070020000");
  send("000#8101");
  EXPECT_EQ(next(1s), "705#00");
  EXPECT_EQ(ask("605#4041600000000000"), "585#4B41600070020000");
  EXPECT_EQ(ask("605#4014100000000000"), "585#4314100085000000");
}

TEST_F(Gsd600, CopiesStoredParametersToTheirObjectsAtTheNextStartOnly) {
  EXPECT_EQ(ask("601#4017100000000000"), "581#4B17100000000000");
  EXPECT_EQ(ask("601#2B002075C8000000"), "581#6000207500000000");  // Pn0116: heartbeat time.
  EXPECT_EQ(ask("601#4017100000000000"), "581#4B17100000000000");
  send("000#8101");
  EXPECT_EQ(next(1s), "701#00");
  EXPECT_EQ(ask("601#4017100000000000"), "581#4B171000C8000000");
  EXPECT_EQ(next(200ms), "701#7F");
}

TEST_F(Gsd600, AddsTheNodeIdToStoredCobIds) {
  EXPECT_EQ(ask("601#4000140100000000"), "581#4300140101020000");
  EXPECT_EQ(ask("601#4000180100000000"), "581#4300180181010040");
  EXPECT_EQ(ask("601#4001180100000000"), "581#43011801810200C0");
}

TEST_F(Gsd600, GoesBackToFactoryValuesByPn0003AtTheNextStart) {
  EXPECT_EQ(ask("601#2B01200F58020000").substr(0, 6), "581#60");
  EXPECT_EQ(ask("601#2B01200F59020000").substr(0, 6), "581#60");
  EXPECT_EQ(ask("601#2B00200401000000"), "581#6000200400000000");
  EXPECT_EQ(ask("601#4001200F00000000").substr(12, 4), "5902");
  send("000#8101");
  EXPECT_EQ(next(1s), "701#00");
  EXPECT_NE(ask("601#4001200F00000000").substr(12, 4), "5902");
  EXPECT_EQ(ask("601#4000200400000000"), "581#4B00200400000000");
}

TEST_F(Gsd600, BootsIntoOperationalWhenPn0198SaysSo) {
  EXPECT_EQ(ask("601#2B0020C701000000"), "581#600020C700000000");
  send("000#8101");
  EXPECT_EQ(next(1s), "701#00");
  EXPECT_EQ(drive().nmt_state(), canopen::NmtState::operational);
}

TEST_F(Gsd600, StoresObjectsBySaveAndForgetsThemByLoad) {
  EXPECT_EQ(ask("601#23816000E8030000"), "581#6081600000000000");
  EXPECT_EQ(ask("601#2310100101020304"), "581#8010100120000008");
  EXPECT_EQ(ask("601#2310100173617665"), "581#6010100100000000");
  send("000#8101");
  EXPECT_EQ(next(1s), "701#00");
  EXPECT_EQ(ask("601#4081600000000000"), "581#43816000E8030000");
  EXPECT_EQ(ask("601#231110016C6F6164"), "581#6011100100000000");
  send("000#8101");
  EXPECT_EQ(next(1s), "701#00");
  EXPECT_NE(ask("601#4081600000000000"), "581#43816000E8030000");
}

TEST_F(Gsd600, ChangesStandstillObjectsOnlyWhileDisabled) {
  EXPECT_EQ(ask("601#2B5A600005000000"), "581#605A600000000000");
  for (const auto* word : {"06", "07", "0F"})
    EXPECT_EQ(ask("601#2B406000" + std::string(word) + "000000"), "581#6040600000000000");
  EXPECT_EQ(ask("601#2B5A600002000000"), "581#805A600022000008");
}

TEST_F(Gsd600, FallsSilentWhenItsCableIsOut) {
  drive().wire_faults().silent = true;
  EXPECT_EQ(ask("601#4041600000000000"), "");
}

TEST(Memory, KeptInAFileOutlivesTheDrive) {
  const auto file = std::filesystem::temp_directory_path() / "servoctl-memory-test.txt";
  std::filesystem::remove(file);
  const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
  for (const int run : {1, 2}) {
    auto bus = open_sim("gsd600@1?state=" + file.string(), folders, SimBus::Clock::virtual_time);
    ASSERT_TRUE(bus) << bus.error().message.text();
    (void)(*bus)->receive((*bus)->now());
    if (run == 1) (void)(*bus)->send(*can::parse_frame("601#2B01200F59020000"));
    if (run == 2) (void)(*bus)->send(*can::parse_frame("601#4001200F00000000"));
    const auto answer = (*bus)->receive((*bus)->now());
    ASSERT_TRUE(answer && *answer);
    EXPECT_EQ(can::to_string(**answer), run == 1 ? "581#6001200F00000000" : "581#4B01200F59020000");
  }
  std::filesystem::remove(file);
}

TEST(Memory, OfAForeignFileIsRefusedAndLeftAlone) {
  const auto file = std::filesystem::temp_directory_path() / "servoctl-memory-foreign.txt";
  std::ofstream(file) << "my diary\n";
  const auto memory = Memory::open(file);
  ASSERT_FALSE(memory);
  EXPECT_EQ(memory.error().code, Errc::file);
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "my diary");
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace servoctl::sim
