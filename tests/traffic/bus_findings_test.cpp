// A picture of the wire for each finding: error frames as Linux drivers write them (linux/can/error.h), and
// what the doctor makes of them.
#include <gtest/gtest.h>

#include "can/candump.hpp"
#include "finding_codes.hpp"

namespace servoctl::traffic {
namespace {

using std::chrono::milliseconds;

/// An error frame: class in the identifier, data[1] controller, [2] kind, [3] place, [4] transceiver.
can::Frame error_frame(std::uint32_t id, std::array<std::uint8_t, 8> data = {}) {
  can::Frame out;
  out.error = true;
  out.id = id;
  out.size = 8;
  out.data = data;
  return out;
}

can::Frame heartbeat(std::uint8_t node) {
  can::Frame out;
  out.id = 0x700U + node;
  out.size = 1;
  out.data[0] = 5;
  return out;
}

// sja1000_err() of Linux 6.1: CAN_ERR_PROT | CAN_ERR_BUSERROR, the kind in data[2], the segment in data[3].
const auto kStuff = error_frame(0x088, {0, 0, 0x04, 0x0A});
const auto kForm = error_frame(0x088, {0, 0, 0x02, 0x1B});
const auto kBit = error_frame(0x088, {0, 0, 0x81, 0x0B});
/// While it sends, of no kind, in the acknowledge slot.
const auto kAckBySja1000 = error_frame(0x088, {0, 0, 0x80, 0x19});
/// Drivers that say it by its class.
const auto kAck = error_frame(0x020);
const auto kPassive = error_frame(0x004, {0, 0x20});
const auto kOverflow = error_frame(0x004, {0, 0x01});
/// slc_bump_err() of Linux 6.1 for an overrun: its class and that of an error of the bus.
const auto kOverflowBySlcan = error_frame(0x08C, {0, 0x01});
const auto kBusOff = error_frame(0x040);

BusPicture picture(const std::vector<can::Frame>& frames, Duration period = milliseconds(10)) {
  BusPicture out(500'000, TimePoint{});
  TimePoint time{};
  for (const auto& frame : frames) out.add(frame, time += period);
  out.end(std::max(time, TimePoint{} + std::chrono::seconds(2)));
  return out;
}

std::vector<can::Frame> times(std::size_t count, const can::Frame& frame) { return {count, frame}; }

std::vector<can::Frame> operator+(std::vector<can::Frame> a, const std::vector<can::Frame>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(BusFindings, OfAHealthyBusAreNoFaults) {
  const auto known = facts();
  const auto heard = bus_findings(picture(times(20, heartbeat(3))), &known);
  EXPECT_EQ(codes(heard), Codes{});
  ASSERT_NE(finding(heard, "traffic"), nullptr);
  EXPECT_NE(finding(heard, "traffic")->text.find("20 frames in 2 s"), std::string::npos);
  EXPECT_NE(finding(heard, "traffic")->text.find("alive: node 3"), std::string::npos);
  EXPECT_EQ(codes(link_findings(known)), Codes{});
}

TEST(BusFindings, OfSilenceAreANote) {
  const auto known = facts();
  EXPECT_EQ(codes(bus_findings(picture({}), &known)), Codes{"silence"});
  EXPECT_EQ(codes(bus_findings(picture({}), nullptr)), Codes{"silence"});
}

TEST(BusFindings, KnowOneThatIsAloneByTheMissingAcknowledge) {
  const auto known = facts(128, 0, can::LinkHealth::error_passive);
  EXPECT_EQ(codes(bus_findings(picture(times(9, kAck)), &known)),
            (Codes{"nobody-acknowledges", "error-passive"}));
  EXPECT_EQ(codes(bus_findings(picture(times(9, kAckBySja1000)), &known)),
            (Codes{"nobody-acknowledges", "error-passive"}));
}

TEST(BusFindings, KnowOneThatIsAloneBeforeItsCountersTellIt) {
  const auto known = facts(8, 0);
  EXPECT_EQ(codes(bus_findings(picture(times(2, kAck)), &known)), Codes{"nobody-acknowledges"});
}

TEST(BusFindings, KnowOneThatIsAloneByItsCountersWhereTheDriverTellsNoErrors) {
  const auto known = facts(128, 0, can::LinkHealth::error_passive);
  const auto found = bus_findings(picture({}), &known);
  EXPECT_EQ(codes(found), (Codes{"nobody-acknowledges", "error-passive"}));
  EXPECT_NE(found.front().text.find("error counter tx 128"), std::string::npos);
  // The same counter among frames is no proof.
  EXPECT_EQ(codes(bus_findings(picture(times(9, heartbeat(1))), &known)), Codes{"error-passive"});
}

TEST(BusFindings, CallNobodyAloneWhoseCountersHaveAnotherReason) {
  const auto passive = can::LinkHealth::error_passive;
  const auto few = facts(100, 0, passive);
  EXPECT_EQ(codes(bus_findings(picture({}), &few)), (Codes{"silence", "error-passive"}));
  const auto both = facts(128, 130, passive);
  EXPECT_EQ(codes(bus_findings(picture({}), &both)), (Codes{"wrong-bitrate", "error-passive"}));
  const auto off = facts(128, 0, can::LinkHealth::bus_off);
  EXPECT_EQ(codes(bus_findings(picture({}), &off)), Codes{"silence"});
  const auto damaged = facts(128, 0, passive);
  EXPECT_EQ(codes(bus_findings(picture(times(5, kStuff)), &damaged)),
            (Codes{"wrong-bitrate", "error-passive"}));
}

TEST(BusFindings, SayWhatIsToBeDoneForTheInterfaceThatThereIs) {
  const auto known = facts();
  EXPECT_EQ(bus_findings(picture({}), &known).front().mend, "`doctor can0 --active` asks them");
  EXPECT_EQ(bus_findings(picture({}), nullptr).front().mend, "`doctor --active` asks them");
  const auto deaf = facts(0, 130);
  const auto found = bus_findings(picture({}), &deaf);
  EXPECT_EQ(found.front().text, "errors and not one frame: error counter rx 130");
  EXPECT_NE(found.front().means.find("another bitrate than 500 kbit/s"), std::string::npos);
  const auto damaged = picture(times(9, kStuff));
  EXPECT_EQ(bus_findings(damaged, nullptr, "slcan:/dev/ttyACM0@500k").front().mend,
            "`bus detect slcan:/dev/ttyACM0@500k` finds the bitrate");
  EXPECT_EQ(bus_findings(damaged, nullptr, "socketcand://plant:29536/can0").front().mend,
            "`bus detect INTERFACE` on the machine that has the interface finds the bitrate");
  auto only_listens = facts();
  only_listens.state.listen_only = true;
  EXPECT_EQ(bus_findings(picture({}), &only_listens).front().mend,
            "`bus up can0` ends the listen-only mode, then `doctor can0 --active` asks them");
}

TEST(BusFindings, TakeErrorsWithoutAFrameForAnotherBitrate) {
  const auto known = facts(0, 128);
  const auto found = bus_findings(picture(times(30, kStuff) + times(4, kForm)), &known);
  EXPECT_EQ(codes(found), Codes{"wrong-bitrate"});
  EXPECT_NE(found.front().text.find("30 × stuff error, 4 × form error"), std::string::npos)
      << found.front().text;
  EXPECT_NE(found.front().mend.find("bus detect can0"), std::string::npos);
}

TEST(BusFindings, TakeCountedErrorsWithoutAFrameForAnotherBitrate) {
  EXPECT_EQ(codes(bus_findings(picture({}),
                               [] {
                                 static auto known = facts(0, 130, can::LinkHealth::error_passive);
                                 return &known;
                               }())),
            (Codes{"wrong-bitrate", "error-passive"}));
  auto counted = facts();
  counted.before->history = can::LinkHistory{.bus_errors = 5};
  counted.state.history = can::LinkHistory{.bus_errors = 50};
  const auto found = bus_findings(picture({}), &counted);
  EXPECT_EQ(codes(found), Codes{"wrong-bitrate"});
  EXPECT_NE(found.front().text.find("45 errors"), std::string::npos);
}

TEST(BusFindings, TakeErrorsAmongFramesForTheTerminators) {
  const auto known = facts();
  const auto found = bus_findings(picture(times(40, heartbeat(1)) + times(10, kForm)), &known);
  EXPECT_EQ(codes(found), Codes{"damaged-frames"});
  EXPECT_NE(found.front().text.find("(20.0 %)"), std::string::npos) << found.front().text;
  EXPECT_NE(found.front().mend.find("60 ohm"), std::string::npos);
  auto counted = facts();
  counted.before->history = can::LinkHistory{.bus_errors = 5};
  counted.state.history = can::LinkHistory{.bus_errors = 15};
  const auto by_driver = bus_findings(picture(times(40, heartbeat(1))), &counted);
  EXPECT_EQ(codes(by_driver), Codes{"damaged-frames"});
  EXPECT_NE(by_driver.front().text.find("10 errors among 40 frames (20.0 %)"), std::string::npos)
      << by_driver.front().text;
}

TEST(BusFindings, NameTheStateOfTheController) {
  const auto known = facts();
  const auto off = facts(0, 0, can::LinkHealth::bus_off);
  EXPECT_EQ(codes(bus_findings(picture({heartbeat(1), kBusOff}), &off)), Codes{}) << "it did not come back";
  EXPECT_EQ(codes(bus_findings(picture({heartbeat(1), kPassive}), &known)), Codes{"error-passive"});
  EXPECT_EQ(codes(bus_findings(picture({heartbeat(1), kBusOff}), &known)), Codes{"bus-off"});
  const auto warned = facts(100, 0, can::LinkHealth::error_warning);
  EXPECT_EQ(codes(bus_findings(picture({heartbeat(1)}), &warned)), Codes{"error-warning"});
}

TEST(BusFindings, NameWhatTheTransceiverSaysOfItsWires) {
  const auto known = facts();
  // CAN_ERR_TRX, CAN_ERR_TRX_CANL_SHORT_TO_CANH
  const auto found = bus_findings(picture({error_frame(0x010, {0, 0, 0, 0, 0x80})}), &known);
  ASSERT_NE(finding(found, "wires"), nullptr);
  EXPECT_NE(finding(found, "wires")->text.find("CAN_L is shorted to CAN_H"), std::string::npos);
}

TEST(BusFindings, TellOfOverload) {
  const auto known = facts();
  EXPECT_EQ(codes(bus_findings(picture({heartbeat(1), kOverflow}), &known)), Codes{"overrun"});
  EXPECT_EQ(codes(bus_findings(picture({heartbeat(1), kOverflowBySlcan}), &known)), Codes{"overrun"});
  auto lost = facts();
  lost.state.traffic.overrun = 7;
  EXPECT_EQ(codes(bus_findings(picture({heartbeat(1)}), &lost)), Codes{"overrun"});
  lost.before->traffic.overrun = 7;
  EXPECT_EQ(codes(bus_findings(picture({heartbeat(1)}), &lost)), Codes{}) << "they were lost before";
  can::Frame full;
  full.id = 0x181;
  full.size = 8;
  full.data = {1, 2, 3, 4, 5, 6, 7, 8};
  // Some 0.23 ms each at 500 kbit/s.
  EXPECT_EQ(codes(bus_findings(picture(times(9000, full), std::chrono::microseconds(235)), &known)),
            Codes{"load"});
  EXPECT_EQ(
      faults_in({{"can0", bus_findings(picture(times(9000, full), std::chrono::microseconds(235)), &known)}}),
      1U);
  EXPECT_EQ(codes(bus_findings(picture(times(7000, full), std::chrono::microseconds(300)), &known)),
            Codes{"load"});
  EXPECT_EQ(
      faults_in({{"can0", bus_findings(picture(times(7000, full), std::chrono::microseconds(300)), &known)}}),
      0U);
}

TEST(BusFindings, TellOfTwoNodesWithOneNumber) {
  const auto known = facts();
  can::Frame boot = heartbeat(5);
  boot.data[0] = 0;
  const auto found = bus_findings(picture({boot, boot}), &known);
  EXPECT_EQ(codes(found), Codes{"duplicate-node"});
  EXPECT_NE(finding(found, "duplicate-node")->mend.find("`address NEW -n 5 -d FAMILY`"), std::string::npos);
}

TEST(BusFindings, TellOfFramesThatAreNotOfCanOpen) {
  const auto known = facts();
  can::Frame other = heartbeat(1);
  other.extended = true;
  other.id = 0x18FEF100;
  EXPECT_EQ(codes(bus_findings(picture({other}), &known)), Codes{"foreign-frames"});
}

TEST(BusFindings, ABusOfCanFdFramesIsNotSilent) {
  const auto known = facts();
  auto silent = bus_findings(picture({}), &known);
  add_fd_frames(silent, "7 CAN FD frames came");
  EXPECT_EQ(codes(silent), Codes{"fd-frames"});
}

}  // namespace
}  // namespace servoctl::traffic
