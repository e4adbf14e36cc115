// The server of CiA 309-3 on simulated drives, in virtual time; lines as CANopenNode's cocomm sends them.
#include "session/gateway_server.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

const std::vector<std::filesystem::path> kGatewayFolders{std::filesystem::path(source_dir()) / "eds"};

class GatewayServing : public testing::Test {
 protected:
  void open(std::string_view spec, bool writes, Options network = {}) {
    auto bus = sim::open_sim(spec, kGatewayFolders, sim::SimBus::Clock::virtual_time);
    ASSERT_TRUE(bus) << bus.error().message.text();
    session.emplace(std::move(*bus), "test", std::move(network));
    ASSERT_TRUE(session->listen());
    server.emplace(
        *session, GatewayServer::Options{
                      .writes = writes,
                      .version = "0.1",
                      .tell = [this](std::string_view line) { told.emplace_back(line); },
                      .energises = [](std::uint8_t, ObjectAddress object,
                                      ByteSpan data) { return object.index == 0x2038 && load_le(data) != 0; },
                      .stop = [this](const std::set<std::uint8_t>& nodes) { stopped.push_back(nodes); }});
    server->on_client(1);
    server->on_client(2);
  }
  /// Until nothing is left to do, or for so long.
  void run(Duration longest = 10s) {
    const auto end = session->now() + longest;
    for (;;) {
      ASSERT_TRUE(server->serve());
      const auto next = server->deadline();
      if (next == kNever || session->now() >= end) return;
      ASSERT_TRUE(session->step(std::min(next, end)));
    }
  }
  std::string ask(std::string_view lines, int who = 1) {
    server->on_bytes(who, lines);
    run();
    return std::exchange(server->output(who), {});
  }

  std::optional<Session> session;
  std::optional<GatewayServer> server;
  std::vector<std::string> told;
  std::vector<std::set<std::uint8_t>> stopped;
};

bool begins(const std::string& text, std::string_view with) { return text.starts_with(with); }

TEST_F(GatewayServing, ReadsByEveryTypeAndWithout) {
  open("gsd600@1", false);
  EXPECT_EQ(ask("[1] 1 r 0x1000 0 u32\r\n"), "[1] 131474\r\n");
  EXPECT_EQ(ask("[2] 1 1 read 0x1000 0\n"), "[2] 92 01 02 00\r\n");
  EXPECT_EQ(ask("[3] 1 r 0x1000 0 x32\n"), "[3] 0x00020192\r\n");
  EXPECT_EQ(ask("[4] 1 r 4096 0 d\n"), "[4] kgECAA==\r\n");
}

TEST_F(GatewayServing, AClientRaisesNoAccessAlarmOnADrive) {
  Options network;
  network.drive_folders = [] { return std::span<const std::filesystem::path>(kGatewayFolders); };
  open("da200@1", true, network);
  EXPECT_TRUE(begins(ask("[1] 1 r 0x603F 0 u16\n"), "[1] ERROR:0x06020000 #"));
  EXPECT_TRUE(begins(ask("[2] 1 r 0x1018 7 u32\n"), "[2] ERROR:0x06090011 #"));
  EXPECT_TRUE(begins(ask("[3] 1 w 0x603F 0 u16 1\n"), "[3] ERROR:0x06020000 #"));
  EXPECT_EQ(ask("[4] 1 r 0x6041 0 x16\n"), "[4] 0x0050\r\n") << "no fault";
  EXPECT_TRUE(begins(ask("[5] 9 r 0x6041 0 x16\n"), "[5] ERROR:0x05040000 #")) << "nobody is there";
}

TEST_F(GatewayServing, ErrorsHaveTheCodesOfTheStandard) {
  open("gsd600@1", true);
  EXPECT_TRUE(begins(ask("[1] 1 r 0x5FFF 0 u32\n"), "[1] ERROR:0x06020000 #"));
  EXPECT_TRUE(begins(ask("[2] 9 r 0x1000 0 u32\n"), "[2] ERROR:0x05040000 #"));
  EXPECT_TRUE(begins(ask("[3] r 0x1000 0\n"), "[3] ERROR:105 #"));
  EXPECT_TRUE(begins(ask("[4] 128 r 0x1000 0\n"), "[4] ERROR:107 #"));
  EXPECT_TRUE(begins(ask("[5] 0 r 0x1000 0\n"), "[5] ERROR:107 #"));
  EXPECT_TRUE(begins(ask("[6] 2 1 r 0x1000 0\n"), "[6] ERROR:106 #"));
  EXPECT_TRUE(begins(ask("[7] 1 lss_store\n"), "[7] ERROR:100 #"));
  EXPECT_TRUE(begins(ask("[8] 1 r 0x1000\n"), "[8] ERROR:101 #"));
  EXPECT_TRUE(begins(ask("[9] 1 r 0x1000 0 u7\n"), "[9] ERROR:101 #"));
  EXPECT_TRUE(begins(ask("[10] 1 w 0x1017 0 u16 65536\n"), "[10] ERROR:101 #"));
  EXPECT_TRUE(begins(ask("[11] 1 w 0x1017 0 u16\n"), "[11] ERROR:101 #"));
  EXPECT_TRUE(begins(ask("[12] 1 start now\n"), "[12] ERROR:101 #"));
  EXPECT_TRUE(begins(ask("1 r 0x1000 0\n"), "[0] ERROR:101 #"));
  EXPECT_TRUE(begins(ask("[13] 1 w 0x1008 0 vs \"x\n"), "[13] ERROR:101 #"));
  EXPECT_TRUE(begins(ask("[14] r " + std::string(5'000, 'x') + "\n"), "[14] ERROR:101 #"));
  EXPECT_EQ(ask("# a comment\n\n"), "\r\n\r\n") << "cocomm waits for an answer to each line";
}

TEST_F(GatewayServing, WritesAndReadsBack) {
  open("gsd600@1", true);
  EXPECT_EQ(ask("[1] set node 1\n[2] w 0x1017 0 u16 1234\n[3] r 0x1017 0 u16\n"),
            "[1] OK\r\n[2] OK\r\n[3] 1234\r\n");
  EXPECT_EQ(ask("[4] w 0x1017 0 hex 64 00\n[5] r 0x1017 0 u16\n"), "[4] OK\r\n[5] 100\r\n");
  EXPECT_TRUE(begins(ask("[6] w 0x1000 0 u32 1\n"), "[6] ERROR:0x06010002 #"));
}

TEST_F(GatewayServing, OnlyReadsUnlessItMayWrite) {
  open("gsd600@1", false);
  for (const auto* line : {"w 0x1017 0 u16 1234", "start", "stop", "preop", "reset node", "reset comm"})
    EXPECT_TRUE(begins(ask("[1] 1 " + std::string(line) + "\n"), "[1] ERROR:102 #")) << line;
  EXPECT_EQ(ask("[2] 1 r 0x1017 0 u16\n"), "[2] 0\r\n");
  EXPECT_EQ(session->watch().state(1), NodeState::pre_operational);
  ASSERT_EQ(told.size(), 1U) << "one line tells of all";
  EXPECT_NE(told[0].find("w 0x1017 0 u16 1234"), std::string::npos) << told[0];
  server->on_lost(1);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_NE(told[1].find("6 of its requests were refused"), std::string::npos) << told[1];
}

TEST_F(GatewayServing, SendsNmtToOneNodeAndToAll) {
  open("gsd600@1,gsd600@2", true);
  EXPECT_EQ(ask("[1] 2 w 0x1017 0 u16 50\n[2] 1 w 0x1017 0 u16 50\n[3] 2 start\n"),
            "[1] OK\r\n[2] OK\r\n[3] OK\r\n");
  ASSERT_TRUE(session->wait([] { return false; }, session->now() + 200ms));
  EXPECT_EQ(session->watch().state(1), NodeState::pre_operational);
  EXPECT_EQ(session->watch().state(2), NodeState::operational);
  EXPECT_EQ(ask("[4] 0 stop\n"), "[4] OK\r\n");
  ASSERT_TRUE(session->wait([] { return false; }, session->now() + 200ms));
  EXPECT_EQ(session->watch().state(1), NodeState::stopped);
  EXPECT_EQ(session->watch().state(2), NodeState::stopped);
}

TEST_F(GatewayServing, EachClientIsAnsweredInItsOrderAndHasItsOwnDefaults) {
  open("gsd600@1", false);
  server->on_bytes(1, "[1] set node 9\n[2] set sdo_timeout 1000\n[3] r 0x1000 0 u32\n[4] 1 r 0x1000 0 u32\n");
  server->on_bytes(2, "[1] 1 r 0x1000 0 u32\n[2] r 0x1000 0 u32\n");
  run(500ms);
  EXPECT_EQ(server->output(1), "[1] OK\r\n[2] OK\r\n") << "its node is silent, and its next line waits";
  EXPECT_TRUE(begins(server->output(2), "[1] 131474\r\n[2] ERROR:105 #")) << server->output(2);
  run();
  EXPECT_NE(server->output(1).find("[3] ERROR:0x05040000"), std::string::npos);
  EXPECT_TRUE(server->output(1).ends_with("[4] 131474\r\n")) << server->output(1);
}

TEST_F(GatewayServing, ADriveThatAClientEnabledIsStoppedWhenItGoes) {
  open("gsd600@1,gsd600@2", true);
  EXPECT_EQ(ask("[1] 1 w 0x6040 0 u16 6\n"), "[1] OK\r\n");
  EXPECT_FALSE(session->energised().contains(1));
  EXPECT_EQ(ask("[2] 1 w 0x6040 0 u16 15\n"), "[2] OK\r\n");
  EXPECT_TRUE(session->energised().contains(1));
  EXPECT_EQ(ask("[1] 2 w 0x6040 0 u16 15\n", 2), "[1] OK\r\n");
  run();
  EXPECT_TRUE(stopped.empty());
  server->on_lost(1);
  run();
  EXPECT_EQ(stopped, (std::vector<std::set<std::uint8_t>>{{1}}));
  EXPECT_EQ(server->energised(), (std::set<std::uint8_t>{2}));
}

TEST_F(GatewayServing, OneThatAClientEnergisedByAParameterIsStoppedWhenItGoesToo) {
  open("ts@1", true);
  EXPECT_EQ(ask("[1] 1 w 0x2038 0 u16 0\r\n"), "[1] OK\r\n");
  EXPECT_TRUE(server->energised().empty());
  EXPECT_EQ(ask("[2] 1 w 0x2038 0 u16 1\r\n"), "[2] OK\r\n");
  EXPECT_EQ(server->energised(), std::set<std::uint8_t>{1});
  server->on_lost(1);
  run();
  EXPECT_EQ(stopped, (std::vector<std::set<std::uint8_t>>{{1}}));
}

TEST_F(GatewayServing, OneThatGoesInTheMiddleOfEnablingIsStoppedToo) {
  open("gsd600@1", true);
  server->on_bytes(1, "[1] 1 w 0x6040 0 u16 15\n[2] 1 w 0x6060 0 i8 3\n");
  server->on_bytes(2, "[1] 1 r 0x1000 0 u32\n");
  ASSERT_TRUE(server->serve());
  EXPECT_TRUE(session->energised().contains(1)) << "noted before it is sent";
  server->on_lost(1);
  run();
  EXPECT_EQ(stopped, (std::vector<std::set<std::uint8_t>>{{1}}));
  EXPECT_EQ(server->output(2), "[1] 131474\r\n") << "the other one is answered, though it had to wait";
}

TEST_F(GatewayServing, WhoDoesNotReadWaitsAndNobodyElse) {
  open("gsd600@1", false);
  for (int i = 0; i < 2'000; ++i) server->on_bytes(1, "[1] help\n");
  EXPECT_EQ(ask("[1] 1 r 0x1000 0 u32\n", 2), "[1] 131474\r\n");
  run();
  EXPECT_LT(server->output(1).size(), GatewayServer::kMostOutput + 2'000);
  EXPECT_FALSE(server->wants_more(1));
  server->output(1).clear();
  run();
  EXPECT_FALSE(server->output(1).empty()) << "it goes on";
}

TEST_F(GatewayServing, WhatWasAskedBeforeTheEndIsAnswered) {
  open("gsd600@1", false);
  server->on_bytes(1, "[1] 1 r 0x1000 0 u32\n[2] 1 r 0x1001 0 u8");
  server->on_end(1);
  EXPECT_FALSE(server->is_done(1));
  run();
  EXPECT_EQ(server->output(1), "[1] 131474\r\n[2] 0\r\n");
  server->output(1).clear();
  EXPECT_TRUE(server->is_done(1));
}

TEST_F(GatewayServing, SaysWhatItIs) {
  open("gsd600@1", false);
  EXPECT_EQ(ask("[1] info version\n"), "[1] 0 0 0.0 0 1 3.0 0.1\r\n");
  const auto help = ask("[2] help\n");
  EXPECT_TRUE(begins(help, "[2] \nLines begin"));
  EXPECT_EQ(help.find("\r\n"), help.size() - 2) << "one answer, for cocomm";
}

}  // namespace
}  // namespace servoctl::session
