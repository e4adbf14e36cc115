// PDOs of simulated drives at work.
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class PdoEngineTest : public CellTest {
 protected:
  void boot(const std::string& family) {
    build(family + "@2");
    commission(cell_);
    ASSERT_EQ(next(100ms), "702#00");
  }
  /// Writes by SDO, which the drive must take.
  void write(const std::string& request) { ASSERT_EQ(ask(request).substr(0, 6), "582#60") << request; }
  /// All frames of so much time.
  std::vector<std::string> listen(Duration time) {
    std::vector<std::string> out;
    const auto end = bus.now() + time;
    while (bus.now() < end)
      if (auto frame = next(end - bus.now()); !frame.empty()) out.push_back(std::move(frame));
    return out;
  }
  using Frames = std::vector<std::string>;

  /// TPDO1 of the family whose PDOs are closed by their count carries the statusword (manual of the TS,
  /// 1753-1767).
  void map_statusword(const std::string& type) {
    for (const auto* request : {"602#2F001A0000000000", "602#23001A0110004160", "602#2F001A0001000000"})
      write(request);
    write("602#2F001802" + type + "000000");
  }
};

TEST_F(PdoEngineTest, SendsNothingBeforeTheDriveIsOperational) {
  boot("ts");
  map_statusword("01");
  send("080#");
  EXPECT_EQ(listen(50ms), Frames{});
  send("000#0102");
  send("080#");
  EXPECT_EQ(next(), "182#5000");
  send("000#8002");
  send("080#");
  EXPECT_EQ(listen(50ms), Frames{});
}

TEST_F(PdoEngineTest, AnswersEveryNthSync) {
  boot("ts");
  map_statusword("03");
  send("000#0102");
  std::string answered;
  for (int i = 0; i < 9; ++i) {
    send("080#");
    answered += next().empty() ? '-' : 'x';
  }
  EXPECT_EQ(answered, "--x--x--x");
}

TEST_F(PdoEngineTest, OfTypeZeroIsSentAtSyncWhenItsValueHasChanged) {
  boot("ts");
  map_statusword("00");
  send("000#0102");
  send("080#");
  EXPECT_EQ(next(), "182#5000");
  send("080#");
  EXPECT_EQ(next(), "");
  write("602#2B40600006000000");
  send("080#");
  EXPECT_EQ(next(), "182#3100");
}

TEST_F(PdoEngineTest, OnChangeKeepsTheInhibitTime) {
  boot("ts");
  map_statusword("FF");
  write("602#2B00180390010000");  // 400 × 100 µs, as the manual writes it (1763).
  send("000#0102");
  EXPECT_EQ(next(), "182#5000");
  write("602#2B40600006000000");
  write("602#2B40600007000000");
  const auto begin = bus.now();
  EXPECT_EQ(next(100ms), "182#3300");
  EXPECT_GE(bus.now() - begin, 35ms);
  EXPECT_EQ(listen(200ms), Frames{}) << "nothing has changed";
}

TEST_F(PdoEngineTest, ByTheEventTimerIsSentWhetherAnythingChangesOrNot) {
  boot("ts");
  map_statusword("FE");
  write("602#2B00180532000000");
  write("602#2B00180300000000");
  send("000#0102");
  EXPECT_EQ(listen(175ms).size(), 4U);
  write("602#2B40600006000000");
  EXPECT_EQ(listen(20ms), Frames{}) << "254 of this family is the timer alone";
}

TEST_F(PdoEngineTest, ReceivedTakesEffectAtOnceOrAtSync) {
  boot("ts");
  for (const auto* request :
       {"602#2F00160000000000", "602#2300160110004060", "602#2F00160001000000", "602#2F001402FF000000"})
    write(request);
  send("202#0600");
  EXPECT_EQ(ask("602#4041600000000000"), "582#4B41600050000000") << "not operational";
  send("000#0102");
  send("202#0600");
  EXPECT_EQ(ask("602#4041600000000000"), "582#4B41600031000000");
  write("602#2F00140201000000");
  send("202#0700");
  EXPECT_EQ(ask("602#4041600000000000"), "582#4B41600031000000");
  send("080#");
  EXPECT_EQ(ask("602#4041600000000000"), "582#4B41600033000000");
  send("202#R2");
  send("202#06");
  EXPECT_EQ(next().substr(0, 8), "082#1082") << "too short for its mapping";
}

TEST_F(PdoEngineTest, IsNotFollowedBeyondWhatAWriteMayDo) {
  boot("gsd600");
  send("000#0102");
  listen(20ms);
  ASSERT_EQ(ask("602#4061600000000000"), "582#4F61600001000000");
  send("302#06007F");  // RPDO2 carries 6040h and 6060h; mode 127 is none.
  EXPECT_EQ(ask("602#4061600000000000"), "582#4F61600001000000");
  EXPECT_EQ(ask("602#4041600000000000"), "582#4B41600031020000") << "the rest of it is taken";
}

TEST_F(PdoEngineTest, WithAStartValueWaitsForTheSyncThatCarriesIt) {
  boot("dm");
  for (const auto* request : {"602#2F001A0000000000", "602#23001A0110004160", "602#2F001A0001000000",
                              "602#2F00180202000000", "602#2F00180603000000", "602#2300180182010000"})
    write(request);
  send("000#0102");
  std::string answered;
  for (const auto* sync : {"080#01", "080#02", "080#03", "080#04", "080#05", "080#01", "080#02"}) {
    send(sync);
    answered += next().empty() ? '-' : 'x';
  }
  EXPECT_EQ(answered, "--x-x-x");
}

}  // namespace
}  // namespace servoctl::sim
