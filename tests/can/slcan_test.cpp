#include "can/slcan.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/signal_wait.hpp"
#include "can/controller_report.hpp"
#include "tests/can/slcan_fixture.hpp"

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::string refusal(const std::string& place) {
  const auto bus = open_slcan(place);
  return bus ? "opened"
             : std::string(name(bus.error().code)) + ": " + bus.error().message.text() + "; " +
                   bus.error().hint.text();
}

TEST(SlcanPlaceText, IsPortBitrateAndPerhapsBaudRate) {
  EXPECT_EQ(parse_slcan_place("/dev/ttyACM0@1M"), (SlcanPlace{"/dev/ttyACM0", 1'000'000, 115'200}));
  EXPECT_EQ(parse_slcan_place("/dev/ttyUSB0@500k,57600"), (SlcanPlace{"/dev/ttyUSB0", 500'000, 57'600}));
  EXPECT_EQ(parse_slcan_place("/dev/serial/by-id/usb@home@125000"),
            (SlcanPlace{"/dev/serial/by-id/usb@home", 125'000, 115'200}));
  for (const char* text :
       {"/dev/ttyACM0", "@500k", "", "/dev/ttyACM0@", "/dev/ttyACM0@83k", "/dev/ttyACM0@750k",
        "/dev/ttyACM0@2M", "/dev/ttyACM0@500", "/dev/ttyACM0@500k,", "/dev/ttyACM0@500k,12",
        "/dev/ttyACM0@18446744073709551616k", "/dev/ttyACM0@-500k", "/dev/ttyACM0@0.5M"}) {
    const auto place = parse_slcan_place(text);
    ASSERT_FALSE(place) << text;
    EXPECT_EQ(place.error().code, Errc::usage) << text;
  }
  EXPECT_NE(parse_slcan_place("/dev/ttyACM0@83k").error().hint.text().find("10k, 20k, 50k"),
            std::string::npos);
}

TEST(Slcan, OpensSendsReceivesAndCloses) {
  ScriptedAdapter adapter;
  {
    const auto bus = open_at(adapter);
    ASSERT_TRUE(bus);
    EXPECT_TRUE(bus->send(slcan_frame("601#4041600000000000")));
    EXPECT_TRUE(bus->send(slcan_frame("701#R1")));
    adapter.say("t58184b41600050020000\rT0000012320102\r");
    EXPECT_EQ(next_frame(*bus), slcan_frame("581#4B41600050020000"));
    EXPECT_EQ(next_frame(*bus), slcan_frame("00000123#0102"));
    EXPECT_EQ(bus->receive(bus->now()).value(), std::nullopt);
  }
  auto heard = adapter.heard();
  std::erase(heard, "F");
  EXPECT_EQ(heard, (std::vector<std::string>{"C", "V", "S6", "O", "t60184041600000000000", "r7011", "C"}));
}

TEST(Slcan, FramesThatComeWithTheLastAcknowledgeAreNotLost) {
  ScriptedAdapter adapter([](const std::string& command) {
    return command == "O" ? "\rt5811AA\r" : ScriptedAdapter::good(command);
  });
  const auto bus = open_at(adapter);
  EXPECT_EQ(next_frame(*bus), slcan_frame("581#AA"));
}

TEST(Slcan, SendsNoFrameThatIsNone) {
  ScriptedAdapter adapter;
  const auto bus = open_at(adapter);
  auto too_long = slcan_frame("601#");
  too_long.size = 9;
  for (const auto& frame : {too_long, slcan_frame("20000004#0001000000000000")}) {
    const auto sent = bus->send(frame);
    ASSERT_FALSE(sent);
    EXPECT_EQ(sent.error().code, Errc::bug);
  }
}

TEST(Slcan, AFrameThatIsRefusedIsOfferedAgainAndInTheEndToldNotSent) {
  int refusals = 0;
  const auto script = [&](const std::string& command) {
    return command.starts_with('t') && ++refusals <= 3 ? "\a" : ScriptedAdapter::good(command);
  };
  ScriptedAdapter adapter(script);
  const auto bus = open_at(adapter);
  EXPECT_TRUE(bus->send(slcan_frame("000#0100")));
  EXPECT_EQ(refusals, 4);
  adapter.set_script([](const std::string& command) {
    return command.starts_with('t') ? "\a" : ScriptedAdapter::good(command);
  });
  const auto sent = bus->send(slcan_frame("000#0100"));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, Errc::bus);
  EXPECT_NE(sent.error().message.text().find("its transmit queue remains full"), std::string::npos);
}

TEST(Slcan, ALostAcknowledgeIsToldAndTheBusGoesOn) {
  int frames = 0;
  ScriptedAdapter adapter([&](const std::string& command) {
    return command.starts_with('t') && ++frames == 2 ? "" : ScriptedAdapter::good(command);
  });
  const auto bus = open_at(adapter);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(bus->send(slcan_frame("601#4041600000000000")));
  EXPECT_EQ(frames, 3) << "nothing is sent twice";
  const auto notices = bus->take_notices();
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices.front().text().find("1 frame was not acknowledged by the adapter"), std::string::npos);
}

TEST(Slcan, AnAdapterWhoseFirstAcknowledgeIsLostIsWaitedForAgain) {
  ScriptedAdapter adapter;
  const auto bus = open_at(adapter);
  int frames = 0;
  adapter.set_script([&](const std::string& line) {
    return line.front() == 't' && frames++ == 0 ? std::string() : ScriptedAdapter::good(line);
  });
  EXPECT_TRUE(bus->send(slcan_frame("601#00")));
  EXPECT_TRUE(bus->take_notices().empty()) << "it may have none for frames";
  EXPECT_TRUE(bus->send(slcan_frame("601#00")));
  (void)bus->receive(bus->now() + milliseconds(100));
  const auto notices = bus->take_notices();
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices.front().text().find("1 frame was not acknowledged by the adapter"), std::string::npos);
  adapter.set_script(
      [](const std::string& line) { return line.front() == 't' ? "\a" : ScriptedAdapter::good(line); });
  EXPECT_FALSE(bus->send(slcan_frame("601#00"))) << "a refusal is waited for";
}

TEST(Slcan, AnAdapterThatFallsSilentIsTold) {
  ScriptedAdapter adapter;
  const auto bus = open_at(adapter);
  EXPECT_TRUE(bus->send(slcan_frame("601#00")));
  adapter.set_script([](const std::string&) { return std::string(); });
  const auto sent = bus->send(slcan_frame("601#00"));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, Errc::bus);
  EXPECT_NE(sent.error().message.text().find("does not answer any more"), std::string::npos);
  EXPECT_FALSE(bus->receive(bus->now())) << "until it is recovered";
  adapter.set_script(ScriptedAdapter::good);
  EXPECT_TRUE(bus->recover(bus->now() + seconds(1)));
  EXPECT_TRUE(bus->send(slcan_frame("601#00")));
}

TEST(Slcan, FirmwareWithoutAcknowledgesIsNotWaitedFor) {
  ScriptedAdapter adapter(
      [](const std::string& command) { return command == "V" ? "b158aa7 github\r" : ""; });
  const auto bus = open_at(adapter);
  const auto begin = bus->now();
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(bus->send(slcan_frame("601#00")));
  EXPECT_LT(bus->now() - begin, milliseconds(250));
  EXPECT_TRUE(adapter.hears("t601100"));
  const auto heard = adapter.heard();
  EXPECT_EQ(std::count(heard.begin(), heard.end(), "F"), 0);
}

TEST(Slcan, StatusFlagsBecomeReportsButThoseOfTheTimeBefore) {
  std::string flags = "F20\r";
  ScriptedAdapter adapter(
      [&](const std::string& command) { return command == "F" ? flags : ScriptedAdapter::good(command); });
  const auto bus = open_at(adapter);
  EXPECT_EQ(bus->receive(bus->now() + milliseconds(100)).value(), std::nullopt) << "old";
  EXPECT_TRUE(adapter.hears("F"));
  const auto report = next_frame(*bus);
  ASSERT_TRUE(report);
  EXPECT_EQ(parse_report(*report), ControllerReport::error_passive);
}

TEST(Slcan, AnAdapterWithoutFlagsIsAskedOnce) {
  ScriptedAdapter adapter(
      [](const std::string& command) { return command == "F" ? "\a" : ScriptedAdapter::good(command); });
  const auto bus = open_at(adapter);
  EXPECT_EQ(bus->receive(bus->now() + milliseconds(1200)).value(), std::nullopt);
  EXPECT_TRUE(bus->send(slcan_frame("601#00")));
  const auto heard = adapter.heard();
  EXPECT_EQ(std::count(heard.begin(), heard.end(), "F"), 1);
}

TEST(Slcan, DamagedLinesAreLeftOutAndTold) {
  ScriptedAdapter adapter;
  const auto bus = open_at(adapter);
  adapter.say("t5818430010009201\rt58184300100092010200\r");
  EXPECT_EQ(next_frame(*bus), slcan_frame("581#4300100092010200"));
  const auto notices = bus->take_notices();
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices.front().text().find("1 damaged line was left out"), std::string::npos);
  EXPECT_TRUE(bus->take_notices().empty());
}

TEST(Slcan, OnePortIsForOneProgram) {
  ScriptedAdapter adapter;
  const auto bus = open_at(adapter);
  EXPECT_NE(refusal(adapter.place()).find("bus: " + adapter.path() + " is in use by another program"),
            std::string::npos);
  EXPECT_TRUE(bus->send(slcan_frame("601#00"))) << "and who has it is not disturbed";
}

TEST(Slcan, WhatIsNoSerialPortIsRefused) {
  EXPECT_NE(refusal("/dev/null@500k").find("bus: /dev/null is no serial port"), std::string::npos);
  const auto file = std::filesystem::path(testing::TempDir()) / "slcan-no-port";
  std::ofstream(file) << "t1230\r";
  EXPECT_NE(refusal(file.string() + "@500k").find("is no serial port"), std::string::npos);
  std::filesystem::remove(file);
  EXPECT_NE(refusal(testing::TempDir() + "@500k").find("is no serial port"), std::string::npos);
  EXPECT_NE(
      refusal("/dev/ttyACM999@500k").find("bus: there is no /dev/ttyACM999; is the adapter plugged in?"),
      std::string::npos);
}

TEST(Slcan, WhatDoesNotAnswerIsNoAdapter) {
  ScriptedAdapter adapter([](const std::string&) { return std::string(); });
  SlcanBus bus(parse_slcan_place(adapter.place()).value(), SlcanOpening::Mode::normal);
  const auto opened = bus.open(bus.now() + milliseconds(100), false);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Errc::bus);
  EXPECT_NE(opened.error().message.text().find("no adapter answers at " + adapter.path()), std::string::npos);
  EXPECT_EQ(bus.poll_fd(), -1);
}

TEST(Slcan, ABitrateThatIsRefusedIsTold) {
  ScriptedAdapter adapter(
      [](const std::string& command) { return command == "S6" ? "\a" : ScriptedAdapter::good(command); });
  EXPECT_NE(refusal(adapter.place()).find("refuses 500 kbit/s"), std::string::npos);
}

TEST(Slcan, ASignalEndsTheOpening) {
  ScriptedAdapter adapter([](const std::string&) { return std::string(); });
  note_signal();
  const auto begin = steady_now();
  const auto bus = open_slcan(adapter.place());
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().code, Errc::interrupted);
  EXPECT_LT(steady_now() - begin, seconds(1));
}

}  // namespace
}  // namespace servoctl::can
