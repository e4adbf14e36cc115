// Simulated drives in a ring on a wire of this process: how they are written, and how their frames go.
#include "sim/sim_port.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "ethercat/frame.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const std::filesystem::path kFolders[] = {std::filesystem::path(source_dir()) / "eds"};

Error refused(std::string_view text) {
  const auto cell = build_esc_cell(text, kFolders, TimePoint{});
  EXPECT_FALSE(cell) << text;
  return cell ? Error{} : cell.error();
}

/// A broadcast read of the AL states, with a counter of 0.
Bytes broadcast_read() {
  Bytes frame{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 2,    0, 0, 0, 0, 1, 0x88, 0xA4, 14,
              0x10, 7,    1,    0,    0,    0x30, 0x01, 2, 0, 0, 0, 0, 0,    0,    0};
  frame.resize(60);
  return frame;
}

class SimPortTest : public testing::Test {
 protected:
  void open(std::string_view text) {
    auto cell = build_esc_cell(text, kFolders, SimClock(SimClock::Kind::virtual_time).now());
    ASSERT_TRUE(cell) << cell.error().message.text();
    port_ = std::make_unique<SimPort>(std::move(*cell), SimClock(SimClock::Kind::virtual_time));
  }
  /// The working counter that comes back within `patience`; -1: none.
  int counter(Duration patience = milliseconds(1)) {
    EXPECT_TRUE(port_->send(broadcast_read()));
    const auto back = port_->receive(port_->now() + patience);
    if (!back || !*back) return -1;
    return (**back)[28] | (**back)[29] << 8;
  }
  std::unique_ptr<SimPort> port_;
};

TEST(EscCell, SlavesAreNumberedByTheirPosition) {
  EXPECT_EQ(refused("sv2@1,sv2@3").message,
            "drive 2 of an EtherCAT ring is node 2, not 3: nodes are positions");
  EXPECT_EQ(refused("sv2@2,sv2@1").message,
            "drive 1 of an EtherCAT ring is node 1, not 2: nodes are positions");
  EXPECT_EQ(refused("sv2@1,sv2@3").hint,
            "simulated EtherCAT drives are written FAMILY@POSITION in the order of the ring, for example "
            "sv2@1,sv2@2?state=FILE");
}

TEST(EscCell, AFamilyWithoutEtherCatIsRefused) {
  const auto error = refused("sv2@1,gsd600@2");
  EXPECT_EQ(error.code, Errc::usage);
  EXPECT_EQ(error.message.text(), "gsd600 has no EtherCAT: the rules of this family have no [coe] section");
  EXPECT_EQ(error.hint.text(), "put it on a simulated CAN bus: sim:gsd600@2");
}

TEST(EscCell, WhatIsWrongInTheTextIsTold) {
  EXPECT_EQ(refused("").message, "no simulated drive is named");
  EXPECT_EQ(refused("@1").message, "a simulated drive has no family name");
  EXPECT_EQ(refused("sv2@0").message, "'0' is not a node-ID (1..127)");
  EXPECT_EQ(
      refused("sv2@1?colour=blue").message,
      "'colour' is not an option of a simulated ring: use state, fault, counts, panel, sii, delay, silent, lose, "
      "short, mailbox, emergency, fall, free-run, clock, lie, lie-after, lie-for, power or cut");
  EXPECT_EQ(refused("sv2@1?delay=20").message.text().substr(0, 7), "delay: ");
  EXPECT_EQ(refused("sv2@1?fault=nonsense").message,
            "'fault=nonsense' is not CODE@TIME or PANEL@TIME; options stand behind all drives: "
            "sim:gsd600@1,dm@2?fault=0xFF00@2s");
}

TEST(EscCell, OptionsReachEverySlave) {
  const auto cell = build_esc_cell("sv2@1,SV2@2?delay=20ms&fault=0xFF00@2s", kFolders, TimePoint{});
  ASSERT_TRUE(cell) << cell.error().message.text();
  ASSERT_EQ(cell->slaves.size(), 2U);
  EXPECT_EQ(cell->profiles.size(), 1U);
  EXPECT_EQ(cell->ring.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    auto& slave = *cell->slaves[i];
    EXPECT_EQ(slave.faults().answer_delay, milliseconds(20));
    EXPECT_EQ(slave.model().node(), i + 1);
    slave.on_time(TimePoint{seconds(1)});
    EXPECT_LT(slave.model().power_state(), drive::DriveState::fault_reaction_active);
    slave.on_time(TimePoint{seconds(2)});
    EXPECT_GE(slave.model().power_state(), drive::DriveState::fault_reaction_active);
  }
}

TEST_F(SimPortTest, AFrameComesBackFromAllSlaves) {
  open("sv2@1,sv2@2,sv2@3");
  const auto before = port_->now();
  EXPECT_EQ(counter(), 3);
  EXPECT_EQ(port_->now() - before, Duration(40));
  const auto next = port_->receive(port_->now() + milliseconds(1));
  ASSERT_TRUE(next);
  EXPECT_FALSE(*next);
}

TEST_F(SimPortTest, AWaitWithoutAFrameEndsAtItsDeadline) {
  open("sv2@1");
  port_->cell().ring.faults().lost_answers = {1};
  const auto before = port_->now();
  EXPECT_EQ(counter(milliseconds(5)), -1);
  EXPECT_EQ(port_->now() - before, milliseconds(5));
  EXPECT_EQ(counter(), 1);
}

TEST_F(SimPortTest, ALateFrameIsAnEventToWaitFor) {
  open("sv2@1");
  port_->cell().ring.faults().delay = milliseconds(3);
  ASSERT_TRUE(port_->send(broadcast_read()));
  EXPECT_EQ(port_->next_event(), port_->now() + milliseconds(3));
  EXPECT_EQ(counter(milliseconds(2)), -1);
  const auto back = port_->receive(port_->now() + milliseconds(1));
  ASSERT_TRUE(back);
  EXPECT_TRUE(*back);
}

TEST_F(SimPortTest, AFrameThatIsTooShortIsABug) {
  open("sv2@1");
  const auto sent = port_->send(Bytes(59));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, Errc::bug);
}

TEST_F(SimPortTest, ARingThatFramesDoNotReachHasNoLink) {
  open("sv2@1");
  EXPECT_TRUE(port_->has_link());
  port_->cell().ring.cut_cable(0);
  EXPECT_FALSE(port_->has_link());
  EXPECT_EQ(counter(), -1);
}

TEST(SimPort, MemoryOutlivesTheProcessInAFile) {
  const auto file = std::filesystem::path(testing::TempDir()) / "sim_port_state.json";
  std::filesystem::remove(file);
  {
    auto cell = build_esc_cell("sv2@1?state=" + file.string(), kFolders, TimePoint{});
    ASSERT_TRUE(cell) << cell.error().message.text();
    cell->memory->cells("1.sv2")[{0x2005, 3}] = {1, 0};
    ASSERT_TRUE(cell->memory->save());
  }
  auto cell = build_esc_cell("sv2@1?state=" + file.string(), kFolders, TimePoint{});
  ASSERT_TRUE(cell) << cell.error().message.text();
  EXPECT_EQ((cell->memory->cells("1.sv2")[{0x2005, 3}]), (Bytes{1, 0}));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace servoctl::sim
