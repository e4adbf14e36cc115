// Error register, error field and emergencies of simulated drives (CiA 301, 7.2.7, 7.5.2.2, 7.5.2.4).
#include "canopen/nmt.hpp"

#include <cstdio>
#include <ios>
#include "sim/error_log.hpp"
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;
using Source = ErrorLog::Source;

class ErrorRegister : public DrivenTest {};

TEST_F(ErrorRegister, AnRpdoThatIsTooShortIsToldOnceRememberedAndOver) {
  boot("cia402");
  EXPECT_EQ(sdo("601#4003100100000000"), "581#8003100124000008") << "no error: 0800 0024h";
  send("000#0101");
  while (!next(5ms).empty()) {
  }
  send("201#0F");  // RPDO1 carries the 16 bits of 6040h.
  EXPECT_EQ(next(), "081#1082110000000000");
  EXPECT_EQ(sdo("601#4001100000000000"), "581#4F01100011000000") << "generic and communication";
  EXPECT_EQ(sdo("601#4003100000000000"), "581#4F03100001000000");
  EXPECT_EQ(sdo("601#4003100100000000"), "581#4303100110820000");
  send("201#0F");
  EXPECT_EQ(next(), "") << "told already";
  send("201#0600");
  EXPECT_EQ(next(), "081#0000000000000000");
  EXPECT_EQ(sdo("601#4001100000000000"), "581#4F01100000000000");
  EXPECT_EQ(sdo("601#4003100100000000"), "581#4303100110820000") << "still remembered";
}

class OfCommunication : public ErrorRegister, public testing::WithParamInterface<const char*> {};

TEST_P(OfCommunication, AFaultSetsBit4AndStandsIn1003h) {
  boot(GetParam());
  for (const auto& [code, bytes] :
       {std::pair<std::uint16_t, const char*>{0x8130, "3081"}, {0x8210, "1082"}}) {
    drive().raise_fault(code, {}, bus.now());
    EXPECT_EQ(sdo("601#4001100000000000"), "581#4F01100011000000") << "generic and communication";
    EXPECT_EQ(emergency_.substr(4, 4), bytes);
    if (profile().dictionary.find({0x1003, 1}) != nullptr) {
      EXPECT_EQ(sdo("601#4003100100000000"), std::string("581#43031001") + bytes + "0000");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, OfCommunication,
                         testing::Values("gsd600", "dm", "da200", "ts", "sv2", "cia402"),
                         [](const auto& test) { return std::string(test.param); });

class RpdoLength : public ErrorRegister, public testing::WithParamInterface<const char*> {
 protected:
  /// RPDO1 carries the controlword and acts at once; the drive is operational.
  void SetUp() override {
    boot(GetParam());
    for (const char* request : {"601#2300140101020080", "601#2F00160000000000", "601#2300160110004060",
                                "601#2F00160001000000", "601#2F001402FE000000", "601#2300140101020000"})
      ASSERT_EQ(sdo(request).substr(0, 6), "581#60") << request;
    send("000#0101");
    while (!next(5ms).empty()) {
    }
  }
  /// The next that is no TPDO: what an RPDO sets off.
  std::string told() {
    auto frame = next();
    while (frame >= "181#" && frame < "580#") frame = next();
    return frame.substr(0, 8);
  }
};

TEST_P(RpdoLength, TooShortIsNotTakenAndToldBy8210h) {  // CiA 301, table 26 and 7.2.2.5.1
  send("201#06");
  EXPECT_EQ(told(), "081#1082");
  EXPECT_EQ(drive().power_state(), drive::DriveState::switch_on_disabled);
  send("201#0600");
  EXPECT_EQ(told(), "081#0000");
  EXPECT_EQ(drive().power_state(), drive::DriveState::ready_to_switch_on);
}

TEST_P(RpdoLength, TooLongIsTakenAsFarAsItIsMappedAndToldBy8220hOnce) {
  send("201#0600FF");
  EXPECT_EQ(told(), "081#2082");
  EXPECT_EQ(drive().power_state(), drive::DriveState::ready_to_switch_on);
  EXPECT_EQ(sdo("601#4001100000000000"), "581#4F01100011000000") << "generic and communication";
  send("201#0700000000000000");
  EXPECT_EQ(told(), "") << "told already";
  EXPECT_EQ(drive().power_state(), drive::DriveState::switched_on);
  send("201#0600");
  EXPECT_EQ(told(), "081#0000");
  EXPECT_EQ(sdo("601#4001100000000000"), "581#4F01100000000000");
}

TEST_P(RpdoLength, TooLongAndThenTooShortAreTwoErrors) {
  send("201#0600FF");
  EXPECT_EQ(told(), "081#2082");
  send("201#06");
  EXPECT_EQ(told(), "081#0000");
  EXPECT_EQ(told(), "081#1082");
}

INSTANTIATE_TEST_SUITE_P(Families, RpdoLength, testing::Values("gsd600", "dm", "da200", "ts", "cia402"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(ErrorRegister, ALostHeartbeatWithoutReactionIsRememberedUntilTheMasterIsBack) {
  boot("cia402");
  write({0x6007, 0}, "0");
  EXPECT_EQ(sdo("601#23161001F4017F00"), "581#6016100100000000");
  const auto beat = canopen::heartbeat_frame(127, canopen::NmtState::operational);
  ASSERT_TRUE(bus.send(beat));
  EXPECT_EQ(next(600ms), "081#3081110000000000");
  EXPECT_EQ(sdo("601#4001100000000000"), "581#4F01100011000000");
  EXPECT_EQ(sdo("601#4003100100000000"), "581#4303100130810000");
  ASSERT_TRUE(bus.send(beat));
  EXPECT_EQ(next(), "081#0000000000000000");
  EXPECT_EQ(sdo("601#4001100000000000"), "581#4F01100000000000");
}

TEST_F(ErrorRegister, AFaultHasTheBitOfItsClass) {
  boot("gsd600");
  for (const auto& [code, text] : {std::pair<std::uint16_t, const char*>{0x2310, "103203"},
                                   {0x3210, "103205"},
                                   {0x4210, "104209"},
                                   {0x7320, "207301"},
                                   {0x8130, "308111"},
                                   {0x8250, "508211"},
                                   {0x8611, "118621"},
                                   {0xFF00, "00FF81"}}) {
    drive().raise_fault(code, {}, bus.now());
    char head[24];
    std::snprintf(head, sizeof head, "081#%02X%02X%.2s", code & 0xFFU, code >> 8U, text + 4);
    EXPECT_EQ(next().substr(0, 10), head) << std::hex << code;
    EXPECT_EQ(sdo("601#4001100000000000"), "581#4F011000" + std::string(text + 4) + "000000");
  }
}

TEST(ErrorLogTest, HoldsTheBitsOfAllThatIsPresent) {
  ErrorLog log;
  EXPECT_EQ(log.error_register(), 0);
  log.begin(Source::fault, 0x3210, 0);
  log.begin(Source::rpdo_short, 0x8210, 0);
  EXPECT_EQ(log.error_register(), 0x15);
  EXPECT_TRUE(log.end(Source::fault));
  EXPECT_FALSE(log.end(Source::fault));
  EXPECT_EQ(log.error_register(), 0x11);
}

TEST(ErrorLogTest, ForgetsTheOldestBeyondItsCapacity) {
  ErrorLog log;
  log.set_capacity(2);
  for (std::uint16_t code = 0x1000; code <= 0x3000; code += 0x1000) log.begin(Source::fault, code, 7);
  EXPECT_EQ(log.history(), (std::deque<std::uint32_t>{0x0007'3000, 0x0007'2000}));
}

}  // namespace
}  // namespace servoctl::sim
