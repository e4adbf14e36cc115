// Error register, error field and emergencies of simulated drives (CiA 301, 7.2.7, 7.5.2.2, 7.5.2.4).
#include "canopen/nmt.hpp"
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
  log.begin(Source::rpdo, 0x8210, 0);
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
