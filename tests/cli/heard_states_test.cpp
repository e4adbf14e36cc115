// What a prompt says of the state of its drive, over each network: heard, never asked for. In virtual time.
#include "cli/heard_states.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "cli/line_runner.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "drive/standard_objects.hpp"
#include "recording_console.hpp"
#include "session/can_network.hpp"
#include "tests/session/ethercat_world.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A prompt on a bus of its own.
struct HeardAt {
  HeardAt(const std::string& bus, const std::string& family, const std::string& node)
      : shell(console, options(bus, family, node)), runner(shell) {
    shell.stay_open(true);
  }
  static Shell::Options options(const std::string& bus, const std::string& family, const std::string& node) {
    Shell::Options out;
    out.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    out.clock = sim::SimBus::Clock::virtual_time;
    out.defaults.bus = bus;
    out.defaults.drive = family;
    out.defaults.nodes = node;
    return out;
  }
  void run(const std::string& line) { ASSERT_EQ(runner.run(line), 0) << line << "\n" << console.err_text; }
  void pass(Duration time) {
    ASSERT_TRUE(shell.session()->wait([] { return false; }, shell.session()->now() + time));
  }
  /// What stands in the brackets.
  std::string state() {
    const auto text = prompt_text(shell).text;
    const auto begin = text.find('[');
    return begin == std::string::npos ? std::string() : text.substr(begin + 1, text.find(']') - begin - 1);
  }

  RecordingConsole console;
  Shell shell;
  LineRunner runner;
};

TEST(HeardStatesTest, OverModbusWithoutAStatuswordAreTheAlarmThatWasRead) {
  HeardAt at("modbus:sim:ts@3?fault=0x1516@0s", "ts", "3");
  at.run("read 0x2033");
  EXPECT_EQ(at.state(), "");
  at.run("param get Dn_12");
  EXPECT_EQ(at.state(), "alarm 0x1516");
  EXPECT_TRUE(prompt_text(at.shell).alarm);
  at.pass(seconds(6));
  EXPECT_EQ(at.state(), "alarm 0x1516?");
}

TEST(HeardStatesTest, OverEtherCatAreThoseOfTheSlaveUntilItsStatuswordIsRead) {
  HeardAt at("coe:sim:sv2@1", "sv2", "1");
  at.run("read 0x1000");
  EXPECT_EQ(at.state(), "PRE-OP");
  at.run("read statusword");
  EXPECT_EQ(at.state(), "switch on disabled");
  at.pass(seconds(6));
  EXPECT_EQ(at.state(), "switch on disabled?");
}

TEST(HeardStatesTest, InAnExchangeComeFromTheProcessImageAndStayFresh) {
  HeardAt at("coe:sim:sv2@1", "sv2", "1");
  at.run("state op --yes");
  at.pass(seconds(6));
  EXPECT_EQ(at.state(), "switch on disabled");
  at.run("write controlword 6 --yes");
  at.pass(milliseconds(100));
  EXPECT_EQ(at.state(), "ready to switch on");
}

TEST(HeardStatesTest, AreNotSureOnceAControlwordWasWritten) {
  for (const auto& [bus, family] : {std::pair("coe:sim:sv2@1", "sv2"), std::pair("sim:gsd600@1", "gsd600")}) {
    HeardAt at(bus, family, "1");
    at.run("status");
    EXPECT_EQ(at.state(), "switch on disabled") << bus;
    at.run("write controlword 6");
    EXPECT_EQ(at.state(), "switch on disabled?") << bus;
    at.run("read statusword");
    EXPECT_EQ(at.state(), "ready to switch on") << bus;
  }
}

TEST(HeardStatesTest, BehindAMotionAreWhatTheDriveSaidLast) {
  HeardAt at("coe:sim:sv2@1", "sv2", "1");
  at.run("enable --yes");
  at.run("status");
  EXPECT_EQ(at.state(), "operation enabled");
  at.run("disable");
  EXPECT_EQ(at.state(), "switch on disabled");
}

TEST(HeardStatesTest, ByTheFactoryMappingOfTpdosAreAssumed) {
  HeardAt at("sim:gsd600@1", "gsd600", "1");
  at.run("nmt start");
  at.pass(milliseconds(2500));
  EXPECT_EQ(at.state(), "switch on disabled?");
  // What is read says the same, and is sure.
  at.run("read statusword");
  EXPECT_EQ(at.state(), "switch on disabled");
  at.pass(milliseconds(2500));
  EXPECT_EQ(at.state(), "switch on disabled");
  at.pass(seconds(6));
  EXPECT_EQ(at.state(), "switch on disabled?");
}

TEST(HeardStatesTest, ByAMappingThatWasReadAreSureUntilItIsWrittenOrTheNodeRestarts) {
  HeardAt at("sim:gsd600@1", "gsd600", "1");
  at.run("nmt start");
  at.pass(milliseconds(2500));
  at.run("pdo show");
  EXPECT_EQ(at.state(), "switch on disabled?") << "that frame came before";
  at.pass(milliseconds(2500));
  EXPECT_EQ(at.state(), "switch on disabled");
  at.run("write 0x1800:1 0xC0000181");
  EXPECT_EQ(at.state(), "switch on disabled?");
  at.run("write 0x1800:1 0x40000181");
  at.run("pdo show");
  at.pass(milliseconds(2500));
  EXPECT_EQ(at.state(), "switch on disabled");
  at.run("nmt reset --wait --yes");
  EXPECT_EQ(at.state(), "pre-operational");
  at.run("nmt start");
  at.pass(milliseconds(2500));
  EXPECT_EQ(at.state(), "switch on disabled?");
}

TEST(HeardStatesTest, AreNotAssumedByTheFactoryMappingOnceSomebodyWroteAnother) {
  HeardAt at("sim:gsd600@1", "gsd600", "1");
  at.run("nmt preop");
  at.run("write 0x1800:1 0xC0000181");
  at.run("write 0x1A00:0 0");
  at.run("write 0x1A00:1 0x60770010");
  at.run("write 0x1A00:0 1");
  at.run("write 0x1800:1 0x40000181");
  at.run("nmt start");
  at.pass(milliseconds(2500));
  EXPECT_EQ(at.state().find("ready"), std::string::npos) << "torque 0 is no statusword: " << at.state();
  EXPECT_EQ(at.state(), "");
}

TEST(HeardStatesTest, OfANodeWhoseHeartbeatIsGoneNoStateIsShownAsCertain) {
  HeardAt at("sim:gsd600@1", "gsd600", "1");
  at.run("heartbeat set 100ms");
  at.run("nmt start");
  at.pass(seconds(1));
  EXPECT_NE(at.state(), "");
  at.run("heartbeat set 0s");
  at.pass(seconds(1));
  EXPECT_TRUE(at.state().ends_with('?')) << at.state();
}

TEST(HeardStatesTest, WithoutAFamilyAreNotTakenFromFramesOfAnUnknownMapping) {
  HeardAt at("sim:gsd600@1", "", "1");
  at.run("nmt start");
  at.pass(milliseconds(2500));
  EXPECT_EQ(at.state().find("switch on"), std::string::npos) << at.state();
}

class HeardOnRing : public session::EtherCatTest {};

TEST_F(HeardOnRing, SlaveThatLeftItsStateIsAFault) {
  open("sv2@1");
  HeardStates heard(*session_);
  ASSERT_TRUE(session_->upload(1, objects::kStatusword));
  EXPECT_EQ(heard.state(1), (HeardStates::State{"switch on disabled", false, false}));
  slave().plan_fall({session_->now() + milliseconds(50), sim::EscState::init, 0x002D});
  pass(milliseconds(500));
  EXPECT_EQ(heard.state(1), (HeardStates::State{"switch on disabled, AL status code 0x002D", false, true}));
}

/// What stands before the line in a window so wide.
std::string prompt_in(Shell& shell, std::size_t window) { return prompt_text(shell, window).text; }

TEST(PromptText, LeavesRoomForTheLineAndNeverShortensNodeAndState) {
  HeardAt at("sim:gsd600@1,gsd600@2,gsd600@3", "gsd600", "1");
  at.run("read statusword");
  const std::string node = " node 1 ";
  const std::string state = " [switch on disabled]> ";
  EXPECT_EQ(prompt_in(at.shell, 0), "servoctl sim:gsd600@1,gsd600@2,gsd600@3" + node + "gsd600" + state);
  EXPECT_EQ(prompt_in(at.shell, 200), prompt_in(at.shell, 0));
  EXPECT_EQ(prompt_in(at.shell, 88), "servoctl sim:gsd6…" + node + "gsd600" + state);
  EXPECT_EQ(prompt_in(at.shell, 40), "sim:gsd…" + node + "gsd600" + state);
  EXPECT_EQ(prompt_in(at.shell, 80), "sim:gsd600@1…" + node + "gsd600" + state)
      << "the name of the program is worth less than the family";
  for (std::size_t window = 1; window < 120; ++window) {
    EXPECT_NE(prompt_in(at.shell, window).find(node), std::string::npos) << window;
    EXPECT_NE(prompt_in(at.shell, window).find(state), std::string::npos) << window;
  }
  at.shell.defaults().bus = "socketcand://cell-7.example:29536/can0";
  EXPECT_TRUE(prompt_in(at.shell, 80).starts_with("servoctl …can0 node 1 gsd600")) << prompt_in(at.shell, 80);
  at.shell.defaults().bus = "slcan:/dev/serial/by-id/usb-CANable_2.0_can0@500k";
  EXPECT_TRUE(prompt_in(at.shell, 110).starts_with("servoctl …usb-CANable_2.0_can0@500k node 1 gsd600"))
      << "its last name is enough";
}

TEST(PromptText, KeepsTheMarkOfAGuessHoweverNarrowTheWindow) {
  HeardAt at("sim:gsd600@1", "", "1");
  at.run("param get Pn0202");
  EXPECT_EQ(prompt_in(at.shell, 0), "servoctl sim:gsd600@1 node 1 gsd600? [pre-operational]> ");
  EXPECT_EQ(prompt_in(at.shell, 40), "sim:gsd… node 1 gsd600? [pre-operational]> ");
}

TEST(PromptText, OfSeveralNodesNamesThoseThatAreInFault) {
  HeardAt at("sim:gsd600@1,dm@2,gsd600@3?fault=0xFF00@0s", "", "1-3");
  at.run("read 0x6041");
  at.pass(seconds(1));
  at.run("fault reset -n 2 -d dm --yes");
  at.run("read 0x6041");
  EXPECT_TRUE(prompt_text(at.shell).text.ends_with(" node 1-3 [node 1 fault, node 3 fault]> "))
      << prompt_text(at.shell).text;
  EXPECT_TRUE(prompt_text(at.shell).alarm);
  at.shell.defaults().chinese = true;
  EXPECT_TRUE(prompt_text(at.shell).text.ends_with(" 节点 1-3 [节点 1 故障，节点 3 故障]> "))
      << prompt_text(at.shell).text;
}

TEST(PromptText, ShowsNoOptionsOfTheBusAndNothingThatWouldMoveTheCursor) {
  HeardAt at("sim:gsd600@1?delay=1ms", "gsd600", "1");
  EXPECT_EQ(prompt_in(at.shell, 0), "servoctl sim:gsd600@1 node 1 gsd600> ");
  at.shell.defaults().bus = "can\x1b[2J0";
  EXPECT_EQ(prompt_in(at.shell, 0).find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace servoctl::cli
