// NMT, boot-up, heartbeat, emergency and abort codes.
#include <gtest/gtest.h>

#include "canopen/emergency.hpp"
#include "canopen/nmt.hpp"
#include "canopen/node_watch.hpp"
#include "canopen/sdo_abort.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

TEST(Nmt, CommandsAreTwoBytesOnIdZero) {
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::start, 5)), "000#0105");
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::stop, 127)), "000#027F");
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::enter_pre_operational, 0)), "000#8000");
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::reset_node, 1)), "000#8101");
  EXPECT_EQ(can::to_string(nmt_frame(NmtCommand::reset_communication, 1)), "000#8201");
}

TEST(Nmt, FramesOfOtherShapeAreNoCommand) {
  EXPECT_TRUE(parse_nmt(frame("000#0105")));
  for (const auto* text : {"000#01", "000#010500", "001#0105", "000#0305", "00000000#0105", "000#R2"})
    EXPECT_FALSE(parse_nmt(frame(text))) << text;
}

TEST(Nmt, NamesGoBothWays) {
  for (const auto command : {NmtCommand::start, NmtCommand::stop, NmtCommand::enter_pre_operational,
                             NmtCommand::reset_node, NmtCommand::reset_communication})
    EXPECT_EQ(parse_nmt_command(name(command)), command);
  EXPECT_FALSE(parse_nmt_command("run"));
}

TEST(ErrorControl, TellsBootUpAndStatesAndDropsTheToggleBit) {
  EXPECT_TRUE(parse_error_control(frame("705#00"))->boot_up);
  EXPECT_EQ(parse_error_control(frame("705#05"))->state, NmtState::operational);
  EXPECT_EQ(parse_error_control(frame("705#85"))->state, NmtState::operational);
  EXPECT_EQ(parse_error_control(frame("77F#7F"))->node, 127);
  for (const auto* text : {"700#05", "780#05", "705#", "705#0500", "705#R", "705#R1", "00000705#05"})
    EXPECT_FALSE(parse_error_control(frame(text))) << text;
}

TEST(Emergency, IsTakenApart) {
  const auto e = parse_emergency(frame("083#30811105060708AA"));
  ASSERT_TRUE(e);
  EXPECT_EQ(e->node, 3);
  EXPECT_EQ(e->code, 0x8130);
  EXPECT_EQ(e->error_register, 0x11);
  EXPECT_EQ(e->vendor, (std::array<std::uint8_t, 5>{5, 6, 7, 8, 0xAA}));
  EXPECT_EQ(can::to_string(emergency_frame(*e)), "083#30811105060708AA");
}

TEST(Emergency, OfTwoBytesIsUnderstoodAndSyncIsNone) {
  EXPECT_EQ(parse_emergency(frame("081#1615"))->code, 0x1516);
  auto longer = frame("081#1615818283");
  longer.size = 2;  // What stands behind the end of a frame is no part of it.
  EXPECT_EQ(parse_emergency(longer)->error_register, 0);
  EXPECT_EQ(parse_emergency(longer)->vendor, (std::array<std::uint8_t, 5>{}));
  EXPECT_EQ(parse_emergency(frame("081#1615818283"))->vendor, (std::array<std::uint8_t, 5>{0x82, 0x83}));
  EXPECT_FALSE(parse_emergency(frame("080#")));
  EXPECT_FALSE(parse_emergency(frame("080#01")));
  EXPECT_FALSE(parse_emergency(frame("081#16")));
  EXPECT_FALSE(parse_emergency(frame("100#0000000000000000")));
}

TEST(Emergency, EveryClassOfCia301HasItsText) {
  // CiA 301 v4.2, table 26: the code, and another one of the same class.
  const std::pair<std::uint16_t, std::string_view> rows[] = {{0x1000, "generic error"},
                                                             {0x2300, "current, output side"},
                                                             {0x2400, "current"},
                                                             {0x3000, "voltage, generic"},
                                                             {0x3400, "voltage"},
                                                             {0x4100, "ambient temperature"},
                                                             {0x4200, "device temperature"},
                                                             {0x4300, "temperature"},
                                                             {0x5000, "device hardware"},
                                                             {0x6000, "device software, generic"},
                                                             {0x6100, "internal software"},
                                                             {0x6200, "user software"},
                                                             {0x6300, "data set"},
                                                             {0x6400, "device software"},
                                                             {0x7000, "additional modules"},
                                                             {0x7100, "additional modules"},
                                                             {0x8000, "monitoring"},
                                                             {0x8100, "communication, generic"},
                                                             {0x8110, "CAN overrun: messages lost"},
                                                             {0x8120, "CAN in error passive mode"},
                                                             {0x8140, "recovered from bus-off"},
                                                             {0x8150, "CAN-ID collision"},
                                                             {0x8200, "protocol error, generic"},
                                                             {0x8210, "PDO not processed: length error"},
                                                             {0x8220, "PDO length exceeded"},
                                                             {0x8250, "RPDO timed out"},
                                                             {0x8300, "monitoring"},
                                                             {0x9000, "external error"},
                                                             {0xF001, "additional functions"},
                                                             {0xFF01, "device specific"}};
  for (const auto& [code, text] : rows) EXPECT_EQ(emergency_text(code), text) << std::hex << code;
}

TEST(Emergency, CodesAreNamedByTheirClass) {
  EXPECT_EQ(emergency_text(0x0000), "error reset or no error");
  EXPECT_EQ(emergency_text(0x8130), "life guard or heartbeat error");
  EXPECT_EQ(emergency_text(0x8131), "communication, generic");
  EXPECT_EQ(emergency_text(0x3210), "voltage inside the device");
  EXPECT_EQ(emergency_text(0x3510), "voltage");
  EXPECT_EQ(emergency_text(0x5441), "device hardware");
  EXPECT_EQ(emergency_text(0x7305), "additional modules");
  EXPECT_EQ(emergency_text(0xFF00), "device specific");
  EXPECT_EQ(error_register_text(0), "none");
  EXPECT_EQ(error_register_text(0x91), "generic, communication, manufacturer");
}

TEST(SdoAbort, HasATextForEveryCodeOfCia301) {
  // CiA 301 v4.2, 7.2.4.3.17, typed from the standard's list.
  const std::uint32_t codes[] = {
      0x05030000, 0x05040000, 0x05040001, 0x05040002, 0x05040003, 0x05040004, 0x05040005, 0x06010000,
      0x06010001, 0x06010002, 0x06020000, 0x06040041, 0x06040042, 0x06040043, 0x06040047, 0x06060000,
      0x06070010, 0x06070012, 0x06070013, 0x06090011, 0x06090030, 0x06090031, 0x06090032, 0x06090036,
      0x060A0023, 0x08000000, 0x08000020, 0x08000021, 0x08000022, 0x08000023, 0x08000024};
  for (const auto code : codes) {
    EXPECT_TRUE(is_standard_sdo_abort(code)) << std::hex << code;
    EXPECT_FALSE(sdo_abort_text(code).empty());
  }
  EXPECT_EQ(sdo_abort_text(0x0607'0010),
            "data type does not match, length of service parameter does not match");
  EXPECT_EQ(sdo_abort_text(0x0602'0000), "object does not exist in the object dictionary");
}

TEST(SdoAbort, OfAVendorIsNamedByItsClass) {
  EXPECT_FALSE(is_standard_sdo_abort(0x0504'0022));
  EXPECT_EQ(sdo_abort_text(0x0504'0022), "service error not listed in CiA 301");
  EXPECT_EQ(sdo_abort_text(0x0606'0010), "access error not listed in CiA 301");
  EXPECT_EQ(sdo_abort_text(0x0F00'1234), "code of the vendor, not listed in CiA 301");
}

class NodeWatchTest : public testing::Test {
 protected:
  void hear(std::string_view text, Duration after) {
    now += after;
    watch.on_time(now);
    watch.on_frame(frame(text), now);
  }
  std::vector<std::size_t> kinds() {
    std::vector<std::size_t> out;
    while (const auto event = watch.take_event()) out.push_back(event->what.index());
    return out;
  }
  static constexpr std::size_t kBootUp = 0, kChange = 1, kLost = 2, kEmergency = 3;
  NodeWatch watch;
  TimePoint now{1s};
};

TEST_F(NodeWatchTest, TellsBootUpAndCountsIt) {
  hear("705#00", 1ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kBootUp});
  EXPECT_EQ(watch.boots(5), 1U);
  EXPECT_EQ(watch.state(5), NmtState::pre_operational);
  EXPECT_EQ(watch.state(6), std::nullopt);
}

TEST_F(NodeWatchTest, TellsAChangeOfStateButNotTheFirstOneHeard) {
  hear("705#7F", 1ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
  hear("705#05", 100ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kChange});
  hear("705#05", 100ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
}

TEST_F(NodeWatchTest, TellsTheLossOfARegularHeartbeatOnceAndItsReturn) {
  for (int i = 0; i < 4; ++i) hear("705#05", 200ms);
  EXPECT_EQ(watch.deadline(), now + 600ms);
  watch.on_time(now + 599ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{});
  watch.on_time(now + 600ms);
  watch.on_time(now + 5s);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kLost});
  EXPECT_EQ(watch.deadline(), kNever);
  hear("705#05", 10s);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kChange});
}

TEST_F(NodeWatchTest, TakesNoExtraMessageAtAChangeForThePeriod) {
  hear("705#7F", 1s);
  hear("705#7F", 1s);
  hear("705#05", 5ms);
  hear("705#05", 995ms);
  hear("705#05", 1s);
  watch.on_time(now + 2900ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kChange});
  watch.on_time(now + 3s);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kLost});
}

TEST_F(NodeWatchTest, DoesNotMissASingleHeartbeatThatWasNeverRepeated) {
  hear("705#05", 1s);
  hear("705#05", 1s);
  EXPECT_EQ(watch.deadline(), kNever);
}

TEST_F(NodeWatchTest, LearnsAnewAfterBootUp) {
  for (int i = 0; i < 4; ++i) hear("705#05", 100ms);
  hear("705#00", 10ms);
  watch.on_time(now + 1h);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kBootUp});
}

TEST_F(NodeWatchTest, TellsNoChangeAfterALostNodeHasBooted) {
  for (int i = 0; i < 4; ++i) hear("705#7F", 100ms);
  watch.on_time(now + 1h);
  now += 1h;
  hear("705#00", 1ms);
  hear("705#7F", 100ms);
  EXPECT_EQ(kinds(), (std::vector<std::size_t>{kLost, kBootUp}));
}

TEST_F(NodeWatchTest, DoesNotTakeTheSilenceOfALostNodeForItsPeriod) {
  for (int i = 0; i < 4; ++i) hear("705#05", 200ms);
  watch.on_time(now + 1s);
  for (int i = 0; i < 4; ++i) hear("705#05", i == 0 ? 10s : Duration(200ms));
  EXPECT_EQ(watch.deadline(), now + 600ms);
}

TEST_F(NodeWatchTest, DoesNotKnowTheStateOfASilentNodeAfterACommand) {
  hear("705#00", 1ms);
  hear("706#00", 1ms);
  hear("707#05", 1ms);
  watch.on_command(5);
  EXPECT_EQ(watch.state(5), std::nullopt);
  EXPECT_EQ(watch.state(6), NmtState::pre_operational);
  watch.on_command(0);
  EXPECT_EQ(watch.state(6), std::nullopt);
  EXPECT_EQ(watch.state(7), NmtState::operational) << "its heartbeats tell";
}

TEST_F(NodeWatchTest, RemembersEmergenciesUntilTheyAreReset) {
  for (int i = 0; i < 9; ++i) hear("085#308111000000000" + std::to_string(i), 1ms);
  EXPECT_EQ(watch.emergencies(5).size(), 8U);
  EXPECT_EQ(watch.emergencies(5).front().vendor[4], 1);
  hear("085#0000000000000000", 1ms);
  EXPECT_TRUE(watch.emergencies(5).empty());
  hear("085#3081110000000000", 1ms);
  hear("705#00", 1ms);
  EXPECT_TRUE(watch.emergencies(5).empty());
}

TEST_F(NodeWatchTest, PassesEmergenciesOn) {
  hear("083#00FF810000000000", 1ms);
  EXPECT_EQ(kinds(), std::vector<std::size_t>{kEmergency});
}

}  // namespace
}  // namespace servoctl::canopen
