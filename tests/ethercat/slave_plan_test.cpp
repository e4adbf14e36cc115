#include "ethercat/slave_plan.hpp"

#include <gtest/gtest.h>

#include "ethercat/registers.hpp"
#include "ethercat/sm_watchdog.hpp"
#include "sii_images.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

constexpr auto kStation = SlaveAddress::station(0x1001);

// The registers as SOEM set them for real slaves: dumps/soem-single-lan9252.pcapng and
// dumps/soem-sdinfo-akd.pcapng of ethercrab (MIT or Apache-2.0).

TEST(SlavePlan, MailboxesAreSetUpAsForRealSlaves) {
  const auto board = mailbox_setup(kStation, {0x1000, 128, 0x1080, 128});
  EXPECT_EQ(board.command, Command::fpwr);
  EXPECT_EQ(board.address, physical_address(0x1001, 0x0800));
  EXPECT_EQ(to_hex(board.data, ""), "00108000260001008010800022000100");
  EXPECT_EQ(to_hex(mailbox_setup(kStation, {0x1800, 1024, 0x1C00, 1024}).data, ""),
            "0018000426000100001C000422000100");
}

TEST(SlavePlan, ProcessDataAreSetUpAsForARealDrive) {
  // 17 bytes each way; this master leaves the watchdog as the SII has it.
  ProcessMapping mapping;
  for (int i = 0; i < 4; ++i) mapping.outputs.push_back({{0x6040, 0}, 32});
  mapping.outputs.push_back({{0x6060, 0}, 8});
  mapping.inputs = mapping.outputs;
  const ProcessArea area{2, 0x1100, 0x24, 3, 0x1140, 0x20};
  const auto plan = plan_slave(1, area, mapping, 0);
  ASSERT_TRUE(plan) << plan.error().message.text();
  const auto requests = plan->requests(kStation, false);
  ASSERT_EQ(requests.size(), 4U);
  EXPECT_EQ(requests[0].address, physical_address(0x1001, 0x0810));
  EXPECT_EQ(to_hex(requests[0].data, ""), "0011110024000100");
  EXPECT_EQ(requests[1].address, physical_address(0x1001, 0x0818));
  EXPECT_EQ(to_hex(requests[1].data, ""), "4011110020000100");
  EXPECT_EQ(requests[2].address, physical_address(0x1001, 0x0600));
  EXPECT_EQ(to_hex(requests[2].data, ""), "00000000110000070011000201000000");
  EXPECT_EQ(requests[3].address, physical_address(0x1001, 0x0610));
  EXPECT_EQ(to_hex(requests[3].data, ""), "11000000110000074011000101000000");
  EXPECT_EQ(plan->requests(kStation)[0].data[4], 0x64) << "with its watchdog";
}

TEST(SlavePlan, TheFixedPdosOfAServoDriveHaveTheLengthsOfItsManual) {
  // 1702h: 6040 607A 60FF 6071 6060 60B8 607F; 1B04h: 603F 6041 6064 6077 6061 60F4 60B9 60BA 60BC 606C.
  ProcessMapping mapping;
  for (const auto bits : {16, 32, 32, 16, 8, 16, 32})
    mapping.outputs.push_back({{0x6040, 0}, static_cast<std::uint8_t>(bits)});
  for (const auto bits : {16, 16, 32, 16, 8, 32, 16, 32, 32, 32})
    mapping.inputs.push_back({{0x6041, 0}, static_cast<std::uint8_t>(bits)});
  EXPECT_EQ(bytes_of(mapping.outputs), 19U);
  EXPECT_EQ(bytes_of(mapping.inputs), 29U);
  const auto plan = plan_slave(1, {2, 0x1800, 0x64, 3, 0x1C00, 0x20}, mapping, 0x40);
  const auto requests = plan->requests(kStation);
  EXPECT_EQ(to_hex(requests[0].data, ""), "0018130064000100");
  EXPECT_EQ(to_hex(requests[1].data, ""), "001C1D0020000100");
  EXPECT_EQ(to_hex(requests[2].data, ""), "40000000130000070018000201000000");
  EXPECT_EQ(to_hex(requests[3].data, ""), "530000001D000007001C000101000000");
}

TEST(SlavePlan, WhatHasNoDataIsSwitchedOff) {
  ProcessMapping mapping;
  mapping.inputs = {{{0x6041, 0}, 16}};
  const auto requests = plan_slave(1, {2, 0x1100, 0x64, 3, 0x1400, 0x20}, mapping, 0)->requests(kStation);
  EXPECT_EQ(to_hex(requests[0].data, ""), "0011000064000000");
  EXPECT_EQ(requests[2].data, Bytes(16));
}

TEST(SlavePlan, BitsAreRoundedUpToBytes) {
  const std::vector<canopen::PdoEntry> entries{{{0x6040, 0}, 16}, {{0x2000, 1}, 1}, {{0x0001, 0}, 4}};
  EXPECT_EQ(bits_of(entries), 21U);
  EXPECT_EQ(bytes_of(entries), 3U);
}

TEST(SlavePlan, AMappingThatLeadsIntoTheOtherBufferIsRefused) {
  ProcessMapping mapping;
  for (int i = 0; i < 6; ++i) mapping.outputs.push_back({{0x6040, 0}, 32});
  const auto plan = plan_slave(3, {2, 0x1100, 0x24, 3, 0x1140, 0x20}, mapping, 0);
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().message.text(),
            "node 3: its outputs need 72 bytes of its memory (three buffers), and 64 are available");
  EXPECT_EQ(plan.error().code, Errc::usage);
  const auto other = plan_slave(3, {2, 0x1140, 0x24, 3, 0x1100, 0x20}, {{}, mapping.outputs}, 0);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message.text(),
            "node 3: its inputs need 72 bytes of its memory (three buffers), and 64 are available");
  const auto unknown = plan_slave(3, {}, mapping, 0);
  EXPECT_EQ(unknown.error().message.text(), "node 3: the location of its process data is unknown");
  mapping.outputs.assign(400, {{0x6040, 0}, 32});
  EXPECT_EQ(plan_slave(3, {2, 0x1000, 0x24, 3, 0x8000, 0x20}, mapping, 0).error().message.text(),
            "node 3: its process data have 1600 bytes, a frame holds 1486");
}

TEST(SlavePlan, TheSiiSaysWhereTheDataAre) {
  const auto area = process_area(parse_sii(full_sii()));
  EXPECT_TRUE(area.exists());
  EXPECT_EQ(area.out_manager, 2);
  EXPECT_EQ(area.out_start, 0x1100);
  EXPECT_EQ(area.out_control, 0x24);
  EXPECT_EQ(area.in_manager, 3);
  EXPECT_EQ(area.in_start, 0x1140);
  EXPECT_FALSE(process_area(SiiImage{}).exists());
}

TEST(SmWatchdog, HasTheTimeThatItWasAskedFor) {
  const auto watchdog = sm_watchdog(100ms);
  ASSERT_TRUE(watchdog);
  EXPECT_EQ(watchdog->divider, 2498);
  EXPECT_EQ(watchdog->steps, 1000);
  EXPECT_EQ(watchdog->time(), 100ms);
  const auto requests = watchdog->requests(kStation);
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_EQ(requests[0].address, physical_address(0x1001, 0x0400));
  EXPECT_EQ(to_hex(requests[0].data), "C2 09");
  EXPECT_EQ(requests[1].address, physical_address(0x1001, 0x0420));
  EXPECT_EQ(to_hex(requests[1].data), "E8 03");
  EXPECT_EQ(sm_watchdog(101us)->steps, 2) << "rounded up";
  EXPECT_FALSE((SmWatchdog{2498, 0}).is_on());
}

TEST(SmWatchdog, OneThatWouldBeNoneOrTooLongIsRefused) {
  EXPECT_EQ(sm_watchdog(0us).error().message.text(), "a watchdog of 0 ms cannot be set");
  EXPECT_FALSE(sm_watchdog(7s));
  EXPECT_FALSE(sm_watchdog(-1s));
}

}  // namespace
}  // namespace servoctl::ethercat
