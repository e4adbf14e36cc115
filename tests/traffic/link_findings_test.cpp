// What is found about an interface of the kernel before anything is heard.
#include <gtest/gtest.h>

#include "finding_codes.hpp"

namespace servoctl::traffic {
namespace {

TEST(LinkFindings, SayWhatIsSetOtherwiseThanUsual) {
  auto down = facts();
  down.state.up = false;
  down.state.bitrate.reset();
  const auto found = link_findings(down);
  EXPECT_EQ(codes(found), Codes{"down"});
  EXPECT_NE(found.front().mend.find("bus up can0 --bitrate 500k"), std::string::npos);

  auto odd = facts();
  odd.state.listen_only = true;
  odd.state.sample_point = 750;
  odd.state.restart_ms = 0;
  odd.state.queue_length = 10;
  odd.may_change = false;
  EXPECT_EQ(codes(link_findings(odd)),
            (Codes{"listen-only", "sample-point", "no-restart", "short-queue", "no-right"}));
  EXPECT_EQ(faults_in({{"can0", link_findings(odd)}}), 1U);
  odd.state.bitrate = 1'000'000;  // 75 % is within what CiA 301 has there.
  EXPECT_EQ(finding(link_findings(odd), "sample-point"), nullptr);

  auto off = facts(0, 0, can::LinkHealth::bus_off);
  off.state.history = can::LinkHistory{.bus_off = 2};
  EXPECT_EQ(codes(link_findings(off)), (Codes{"bus-off", "was-bus-off"}));

  can::LinkState plain;
  plain.kind = "vcan";
  plain.up = true;
  EXPECT_EQ(codes(link_findings({.name = "vcan0", .state = plain})), Codes{});
}

TEST(LinkFindings, TellOfWhatHoldsTheControllerBackAndOfNothingElse) {
  auto odd = facts(5, 7);
  odd.state.loopback = true;
  odd.state.sample_point = 950;
  odd.state.termination = 120;
  odd.state.history = can::LinkHistory{.bus_off = 0};
  const auto found = link_findings(odd);
  EXPECT_EQ(codes(found), (Codes{"loopback", "sample-point", "termination"}));
  EXPECT_NE(found.front().text.find("error counters tx 5 rx 7"), std::string::npos) << found.front().text;
  EXPECT_NE(finding(found, "termination")->text.find("with 120 ohm"), std::string::npos);
  EXPECT_NE(finding(found, "termination")->mend.find("termination 0`"), std::string::npos);
  odd.state.termination = 0;
  EXPECT_NE(finding(link_findings(odd), "termination")->text.find("is off"), std::string::npos);
  EXPECT_NE(finding(link_findings(odd), "termination")->mend.find("termination 120`"), std::string::npos);

  auto stopped = facts(0, 0, can::LinkHealth::stopped);
  stopped.state.history = can::LinkHistory{.bus_off = 1};
  EXPECT_EQ(codes(link_findings(stopped)), (Codes{"bus-off", "was-bus-off"}));
  EXPECT_NE(finding(link_findings(stopped), "was-bus-off")->text.find("1 time since"), std::string::npos);

  auto unset = facts();
  unset.state.bitrate.reset();
  unset.state.restart_ms = 0;
  EXPECT_EQ(codes(link_findings(unset)), Codes{}) << "where it has no bitrate it restarts nothing";
}

TEST(LinkFindings, SayHowAnInterfaceComesUp) {
  auto down = facts();
  down.state.up = false;
  EXPECT_EQ(link_findings(down).front().mend, "`bus up can0`, or with another --bitrate");
  down.state.kind = "vcan";
  EXPECT_EQ(link_findings(down).front().mend, "`bus up can0`");
}

TEST(LinkFindings, TellAMissingAdapterFromAMissingKernel) {
  EXPECT_EQ(codes(no_interface_findings(true, {})), Codes{"no-adapter"});
  EXPECT_EQ(codes(no_interface_findings(false, {})), Codes{"no-kernel-can"});
}

TEST(LinkFindings, NameTheSerialPortsThatNeedNoDriver) {
  for (const bool kernel_has_can : {false, true}) {
    const auto none = no_interface_findings(kernel_has_can, {}).front().mend;
    EXPECT_NE(none.find("`scan -b slcan:PORT@500k`; none is plugged in now"), std::string::npos) << none;
    const auto two = no_interface_findings(kernel_has_can, {"/dev/ttyACM0", "/dev/ttyUSB1"}).front().mend;
    EXPECT_NE(two.find("`scan -b slcan:/dev/ttyACM0@500k`"), std::string::npos) << two;
    EXPECT_NE(two.find("USB serial ports: /dev/ttyACM0, /dev/ttyUSB1"), std::string::npos) << two;
  }
}

}  // namespace
}  // namespace servoctl::traffic
