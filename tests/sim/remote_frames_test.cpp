// What simulated drives answer to a remote frame that asks for a TPDO (CiA 301, 7.2.2.3 and table 72).
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

class RemoteFrames : public DrivenTest {
 protected:
  void take(const std::string& request) { ASSERT_EQ(sdo(request).substr(0, 6), "581#60") << request; }
  /// TPDO1 carries the statusword; `cob_id` and `type` as they go over the wire.
  void map_statusword(const std::string& cob_id, const std::string& type) {
    take("601#2300180181010080");
    for (const char* request : {"601#2F001A0000000000", "601#23001A0110004160", "601#2F001A0001000000"})
      take(request);
    take("601#2F001802" + type + "000000");
    take("601#23001801" + cob_id);
  }
  /// The drive starts; what it sends by itself then is not looked at.
  void start() {
    send("000#0101");
    while (!next(5ms).empty()) {
    }
  }
  /// TPDO1 within this time; the other TPDOs are none of it.
  std::string tpdo1(Duration patience) {
    const auto end = bus.now() + patience;
    auto frame = next(patience);
    while (!frame.empty() && frame.substr(0, 4) != "181#") frame = next(end - bus.now());
    return frame;
  }
  std::string ask_tpdo1() {
    send("181#R2");
    return tpdo1(5ms);
  }
};

struct Answer {
  const char* family;
  const char* frame;  ///< The statusword behind its power-on.
};

class OnRequestAlone : public RemoteFrames, public testing::WithParamInterface<Answer> {};

TEST_P(OnRequestAlone, Type253IsSent) {
  boot(GetParam().family);
  map_statusword("81010000", "FD");
  EXPECT_EQ(ask_tpdo1(), "") << "not operational";
  send("000#0101");
  EXPECT_EQ(tpdo1(50ms), "") << "by itself";
  send("080#");
  EXPECT_EQ(tpdo1(50ms), "") << "at SYNC";
  EXPECT_EQ(ask_tpdo1(), GetParam().frame);
  EXPECT_EQ(ask_tpdo1(), GetParam().frame);
  send("182#R2");
  EXPECT_EQ(tpdo1(5ms), "") << "that of another node";
  send("000#8001");
  EXPECT_EQ(ask_tpdo1(), "") << "not operational any more";
}

INSTANTIATE_TEST_SUITE_P(Families, OnRequestAlone,
                         testing::Values(Answer{"da200", "181#5002"}, Answer{"ts", "181#5000"},
                                         Answer{"cia402", "181#5002"}),
                         [](const auto& test) { return std::string(test.param.family); });

class AtSyncAndOnRequest : public OnRequestAlone {};

TEST_P(AtSyncAndOnRequest, Type252AnswersWithTheValuesOfTheLastSync) {
  boot(GetParam().family);
  const std::string last = std::string(GetParam().frame).substr(6);
  map_statusword("81010000", "FC");
  start();
  EXPECT_EQ(ask_tpdo1(), "") << "nothing was sampled yet";
  send("080#");
  EXPECT_EQ(tpdo1(5ms), "") << "sampled, not sent";
  take("601#2B40600006000000");
  EXPECT_EQ(ask_tpdo1(), GetParam().frame);
  send("080#");
  EXPECT_EQ(ask_tpdo1(), "181#31" + last);
}

INSTANTIATE_TEST_SUITE_P(Families, AtSyncAndOnRequest,
                         testing::Values(Answer{"ts", "181#5000"}, Answer{"cia402", "181#5002"}),
                         [](const auto& test) { return std::string(test.param.family); });

TEST_F(RemoteFrames, Type252OfTheDa200IsSentAtTheSyncAfterARemoteFrame) {  // 284
  boot("da200");
  map_statusword("81010000", "FC");
  start();
  send("080#");
  EXPECT_EQ(ask_tpdo1(), "");
  take("601#2B40600006000000");
  send("080#");
  EXPECT_EQ(tpdo1(5ms), "181#3102");
  send("080#");
  EXPECT_EQ(tpdo1(5ms), "") << "once for a request";
}

TEST_F(RemoteFrames, EventDrivenTpdosAnswerWhereBit30AllowsIt) {
  boot("cia402");
  for (const char* type : {"FE", "FF"}) {
    send("000#8001");
    map_statusword("81010000", type);
    start();
    EXPECT_EQ(ask_tpdo1(), "181#5002") << type;
    send("000#8001");
    map_statusword("81010040", type);
    start();
    EXPECT_EQ(ask_tpdo1(), "") << type << ", bit 30";
  }
  send("000#8001");
  map_statusword("81010080", "FE");
  start();
  EXPECT_EQ(ask_tpdo1(), "") << "not valid";
}

TEST_F(RemoteFrames, SynchronousTpdosDoNotAnswer) {
  boot("cia402");
  map_statusword("81010000", "01");
  start();
  EXPECT_EQ(ask_tpdo1(), "");
  send("080#");
  EXPECT_EQ(tpdo1(5ms), "181#5002");
}

TEST_F(RemoteFrames, TheInhibitTimeHoldsTheAnswerBack) {
  boot("cia402");
  take("601#2300180181010080");
  take("601#2B001803E8030000");  // 1000 times 100 us.
  map_statusword("81010000", "FE");
  send("000#0101");
  ASSERT_EQ(tpdo1(5ms), "181#5002");
  send("181#R2");
  EXPECT_EQ(tpdo1(95ms), "");
  EXPECT_EQ(tpdo1(10ms), "181#5002");
  EXPECT_EQ(tpdo1(200ms), "") << "once for a request";
}

TEST_F(RemoteFrames, AreNotAnsweredByTheGsd600) {  // Bit 30 is set (1638), and stays (1636).
  boot("gsd600");
  start();
  EXPECT_EQ(ask_tpdo1(), "");
}

TEST_F(RemoteFrames, OfTheDmAskForEventDrivenTpdosOnly) {
  boot("dm");
  EXPECT_EQ(sdo("601#2F001802FC000000"), "581#8000180230000906");  // 241 to 253 are not used (745).
  EXPECT_EQ(sdo("601#2F001802FD000000"), "581#8000180230000906");
  map_statusword("81010000", "FE");
  start();
  EXPECT_EQ(ask_tpdo1(), "181#5002");  // Bit 30 is 0: RTR enabled (736).
}

}  // namespace
}  // namespace servoctl::sim
