#include "ethercat/ring_look.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "ethercat/registers.hpp"
#include "hex.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

/// Registers of a slave from 0000h on.
Bytes registers(std::uint16_t station, std::uint8_t state) {
  Bytes out(0x0400);
  const auto head = hex("1100 0200 0304 0800 0C00 0000 0000 0000");
  std::copy(head.begin(), head.end(), out.begin());
  store_le(station, std::span(out).subspan(0x10, 2));
  out[0x12] = 7;
  out[0x110] = 0x31;  // Links at ports 0 and 1.
  out[0x111] = 0x5A;  // Ports 0 and 1 open with a signal, 2 and 3 turned round.
  out[0x130] = state;
  out[0x134] = 0x1B;
  for (std::size_t i = 0; i < 20; ++i) out[0x300 + i] = static_cast<std::uint8_t>(i + 1);
  return out;
}

class RingLookTest : public testing::Test {
 protected:
  Result<RingLook::View> run() {
    look.start(now);
    while (look.busy()) {
      const auto request = look.take_request();
      if (!request) {
        ADD_FAILURE() << "it waits for nothing";
        break;
      }
      EXPECT_FALSE(writes(request->command)) << "it changes nothing";
      look.on_answer(answer(*request), now);
    }
    const auto result = look.take_result();
    EXPECT_TRUE(result);
    EXPECT_FALSE(look.take_result());
    return result ? *result : Result<RingLook::View>(fail(Errc::bug, "none"));
  }
  Answer answer(const Request& request) {
    if (lost) return {{}, 0, true, now};
    if (request.command == Command::brd)
      return {request.data, static_cast<std::uint16_t>(slaves.size() - uncounted), false, now};
    EXPECT_EQ(request.command, Command::aprd);
    const auto position = static_cast<std::uint16_t>(0U - (request.address & 0xFFFFU));
    if (position >= slaves.size() || position == gone) return {request.data, 0, false, now};
    const auto where = static_cast<std::ptrdiff_t>(request.address >> 16U);
    reply.assign(slaves[position].begin() + where,
                 slaves[position].begin() + where + static_cast<std::ptrdiff_t>(request.data.size()));
    return {reply, 1, false, now};
  }

  std::vector<Bytes> slaves;
  bool lost = false;
  std::size_t uncounted = 0;
  std::uint16_t gone = 0xFFFF;
  RingLook look;
  TimePoint now{1s};
  Bytes reply;
};

TEST_F(RingLookTest, EachSlaveSaysWhatItIsInItsOrder) {
  slaves = {registers(0x1001, 2), registers(0, 1)};
  const auto view = run();
  ASSERT_TRUE(view);
  EXPECT_EQ(view->count, 2U);
  ASSERT_EQ(view->slaves.size(), 2U);
  const auto& first = view->slaves[0];
  EXPECT_EQ(first.type, 0x11);
  EXPECT_EQ(first.fmmus, 3);
  EXPECT_EQ(first.sync_managers, 4);
  EXPECT_EQ(first.features & reg::kFeatureDc, reg::kFeatureDc);
  EXPECT_EQ(first.station, 0x1001);
  EXPECT_EQ(first.alias, 7);
  EXPECT_EQ(first.al, (AlStatus{AlState::preop, false, 0x1B}));
  EXPECT_EQ(view->slaves[1].station, 0);
  EXPECT_EQ(view->slaves[1].al.state, AlState::init);
  EXPECT_FALSE(view->is_in_use());
}

TEST_F(RingLookTest, PortsAndTheirCountersAreTold) {
  slaves = {registers(0x1001, 2)};
  const auto view = run();
  ASSERT_TRUE(view);
  const auto& ports = view->slaves[0].ports;
  EXPECT_TRUE(ports[0].link && ports[0].open && ports[0].signal);
  EXPECT_TRUE(ports[1].link && ports[1].open && ports[1].signal);
  EXPECT_FALSE(ports[2].link || ports[2].open || ports[2].signal);
  EXPECT_EQ(ports[0].bad_frames, 1);
  EXPECT_EQ(ports[0].bad_symbols, 2);
  EXPECT_EQ(ports[3].bad_symbols, 8);
  EXPECT_EQ(ports[1].forwarded, 10);
  EXPECT_EQ(ports[2].lost_links, 19);
  EXPECT_EQ(view->slaves[0].bad_commands, 13);
  EXPECT_EQ(view->slaves[0].pdi_errors, 14);
}

TEST_F(RingLookTest, TheEndOfALineIsWhereThePortsSayIt) {
  // Two boards in a row in dumps/soem-dual-lan9252.pcapng of ethercrab (MIT or Apache-2.0), frames 144 and
  // 338.
  const auto first = parse_slave_look({}, hex("375A"), {}, {});
  EXPECT_TRUE(first.ports[0].open && first.ports[1].open);
  EXPECT_FALSE(first.ports[2].open || first.ports[3].open);
  const auto last = parse_slave_look({}, hex("1756"), {}, {});
  EXPECT_TRUE(last.ports[0].open && last.ports[0].link);
  EXPECT_FALSE(last.ports[1].open || last.ports[1].link);
}

TEST_F(RingLookTest, ARingThatSomebodyCyclesIsKnown) {
  slaves = {registers(0x1001, 2), registers(0x1002, 0x14)};
  EXPECT_TRUE(run()->is_in_use());
  slaves = {registers(0x1001, 8)};
  EXPECT_TRUE(run()->is_in_use());
}

TEST_F(RingLookTest, NothingOnTheWireAndNoWireAtAllAreTwoThings) {
  const auto empty = run();
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().code, Errc::bus);
  EXPECT_EQ(empty.error().message.text(), "no EtherCAT slave is there");
  lost = true;
  const auto none = run();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Errc::bus);
  EXPECT_EQ(none.error().message.text(), "frames do not come back");
  EXPECT_NE(none.error().hint.text(), "");
}

TEST_F(RingLookTest, ASlaveThatGoesMeanwhileIsNamed) {
  slaves = {registers(0x1001, 2), registers(0x1002, 2), registers(0x1003, 2)};
  gone = 1;
  const auto view = run();
  ASSERT_FALSE(view);
  EXPECT_EQ(view.error().message.text(), "the slave at position 2 no longer answers");
  EXPECT_EQ(view.error().node, 2);
}

TEST_F(RingLookTest, ACountThatComesBackShortHidesNoSlave) {
  slaves = {registers(0x1001, 2), registers(0x1002, 2), registers(0x1003, 8)};
  uncounted = 1;
  const auto view = run();
  ASSERT_TRUE(view) << view.error().message.text();
  EXPECT_EQ(view->count, 3U);
  ASSERT_EQ(view->slaves.size(), 3U);
  EXPECT_TRUE(view->is_in_use());
}

TEST_F(RingLookTest, MoreSlavesThanNodesAreCountedAndNotLookedAt) {
  slaves.assign(130, registers(0x1001, 2));
  const auto view = run();
  EXPECT_EQ(view->count, 130U);
  EXPECT_EQ(view->slaves.size(), 127U);
}

}  // namespace
}  // namespace servoctl::ethercat
