// What goes wrong in a simulated ring, set by its text.
#include "sim/esc_cell_options.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "sim/sim_port.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const std::filesystem::path kFolders[] = {std::filesystem::path(source_dir()) / "eds"};

class EscCellOptionsTest : public testing::Test {
 protected:
  void build(std::string_view options) {
    auto cell = build_esc_cell("sv2@1,sv2@2?" + std::string(options), kFolders, start_);
    ASSERT_TRUE(cell) << cell.error().message.text();
    cell_ = std::move(*cell);
  }
  static std::string refused(std::string_view options) {
    const auto cell = build_esc_cell("sv2@1,sv2@2?" + std::string(options), kFolders, TimePoint{});
    EXPECT_FALSE(cell) << options;
    return cell ? std::string() : cell.error().message.text();
  }
  /// The working counter of a broadcast read at this time; -1: the frame does not come back.
  int counter(Duration at) {
    Bytes frame{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 2,    0, 0, 0, 0, 1, 0x88, 0xA4, 14,
                0x10, 7,    1,    0,    0,    0x30, 0x01, 2, 0, 0, 0, 0, 0,    0,    0};
    frame.resize(60);
    cell_.ring.on_frame(frame, start_ + at);
    const auto back = cell_.ring.take_frame();
    return back ? (*back)[28] | (*back)[29] << 8 : -1;
  }
  std::string counters(int count) {
    std::string out;
    for (int i = 0; i < count; ++i) out += std::to_string(counter({})) + " ";
    return out;
  }

  TimePoint start_{seconds(7)};
  EscCell cell_;
};

TEST_F(EscCellOptionsTest, EveryNthFrameIsLost) {
  build("lose=3");
  EXPECT_EQ(counters(7), "2 2 -1 2 2 -1 2 ");
}

TEST_F(EscCellOptionsTest, EveryNthFrameHasShortCounters) {
  build("short=2");
  EXPECT_EQ(counters(5), "2 1 2 1 2 ");
}

TEST_F(EscCellOptionsTest, ACableIsCutAndJoinedAgain) {
  build("cut=2@5s-8s&cut=1@20s");
  EXPECT_EQ(cell_.ring.deadline(), start_ + seconds(5));
  EXPECT_EQ(counter(milliseconds(4999)), 2);
  EXPECT_EQ(counter(seconds(5)), 1);
  EXPECT_EQ(counter(milliseconds(7999)), 1);
  EXPECT_EQ(counter(seconds(8)), 2);
  EXPECT_EQ(counter(seconds(20)), -1);
  EXPECT_EQ(counter(seconds(2000)), -1);
}

TEST_F(EscCellOptionsTest, APowerCycleTakesTheStationAddress) {
  build("power=1@5s-6s");
  EXPECT_TRUE(cell_.slaves[0]->registers().write(0x0010, Bytes{0x01, 0x10}));
  EXPECT_EQ(counter(milliseconds(4999)), 2);
  EXPECT_EQ(counter(seconds(5)), -1);
  EXPECT_EQ(cell_.slaves[0]->registers().station(), 0x1001U);
  EXPECT_EQ(counter(seconds(6)), 2);
  EXPECT_EQ(cell_.slaves[0]->registers().station(), 0U);
}

TEST_F(EscCellOptionsTest, SilenceIsThatNoFrameComesBack) {
  build("silent=5s");
  EXPECT_EQ(counter(milliseconds(4999)), 2);
  EXPECT_EQ(counter(seconds(5)), -1);
}

TEST_F(EscCellOptionsTest, FaultsOfTheDrivesReachAllOfThem) {
  build("mailbox=full&emergency=3&free-run=no&delay=7ms");
  for (const auto& slave : cell_.slaves) {
    EXPECT_TRUE(slave->faults().mailbox_stays_full);
    EXPECT_EQ(slave->faults().emergencies, 3U);
    EXPECT_TRUE(slave->faults().refuses_free_run);
    EXPECT_EQ(slave->faults().answer_delay, milliseconds(7));
  }
}

TEST_F(EscCellOptionsTest, SlavesLeaveTheirStateByThemselves) {
  build("fall=0x1B@5s");
  EXPECT_EQ(cell_.slaves[1]->deadline(), start_ + seconds(5));
  build("fall=4s");
  EXPECT_EQ(cell_.slaves[0]->deadline(), start_ + seconds(4));
}

TEST_F(EscCellOptionsTest, WhatIsWrongWithAnSiiIsNamed) {
  for (const auto* name : {"checksum", "blank", "cut-short", "mailboxes", "mute"}) {
    const auto text = "sv2@1?sii=" + std::string(name);
    const auto spec = parse_cell_spec(text, {});
    ASSERT_TRUE(spec);
    const auto fault = sii_fault_of(*spec);
    ASSERT_TRUE(fault) << name;
    EXPECT_NE(*fault, SiiFault::none) << name;
    build("sii=" + std::string(name));
  }
  EXPECT_EQ(refused("sii=bad"),
            "'sii=bad': what is wrong with an SII is checksum, blank, cut-short, mailboxes or mute");
}

TEST_F(EscCellOptionsTest, WhatIsNoneIsRefused) {
  EXPECT_EQ(refused("lose=0"), "'lose=0': every how many frames one is lost is a number from 1");
  EXPECT_EQ(refused("short=x"), "'short=x': every how many frames one has short counters is a number from 1");
  EXPECT_EQ(refused("emergency=-1"),
            "'emergency=-1': before how many answers an emergency comes is a number from 1");
  EXPECT_EQ(refused("mailbox=empty"), "'mailbox=empty': the one fault of a mailbox is mailbox=full");
  EXPECT_EQ(refused("free-run=yes"), "'free-run=yes': drives that need SYNC0 are free-run=no");
  for (const auto* fall : {"5", "x@5s", "0x10000@5s", "0x1B@"})
    EXPECT_EQ(refused("fall=" + std::string(fall)),
              "'fall=" + std::string(fall) + "': a fall is TIME or CODE@TIME, such as fall=0x1B@5s");
  for (const auto* cut : {"2", "0@5s", "3@5s", "1@", "1@5s-", "1@5s-5s", "1@5s-4s", "@5s"})
    EXPECT_EQ(
        refused("cut=" + std::string(cut)),
        "'cut=" + std::string(cut) +
            "': it is POSITION@TIME or POSITION@FROM-TO, with a position of 1 to 2, such as cut=1@5s-8s");
  EXPECT_EQ(refused("power=2").substr(0, 11), "'power=2': ");
  EXPECT_EQ(refused("silent=5").substr(0, 8), "silent: ");
}

}  // namespace
}  // namespace servoctl::sim
