// The wire of simulated slaves: lost and damaged frames, cut cables, power that goes and comes back.
#include "esc_support.hpp"

namespace servoctl::sim {
namespace {

using std::chrono::milliseconds;

class EscRingTest : public EscTest {
 protected:
  int count() { return datagram(kBrd, 0, Bytes(2, 0)).counter; }
  static constexpr std::uint16_t kThird = 0x1003;
};

TEST_F(EscRingTest, AnEmptyRingSaysNothing) { EXPECT_EQ(count(), -1); }

TEST_F(EscRingTest, ALostRequestDoesNothingAndALostAnswerWasDone) {
  build(1);
  ring_.faults().lost_requests = {ring_.sent() + 1};
  EXPECT_EQ(write(0x0420, "1111"), -1);
  EXPECT_EQ(show(0x0420, 2), "E8 03");
  ring_.faults().lost_answers = {ring_.sent() + 1};
  EXPECT_EQ(write(0x0420, "1111"), -1);
  EXPECT_EQ(show(0x0420, 2), "11 11");
}

TEST_F(EscRingTest, EveryNthAnswerIsLost) {
  build(1);
  ring_.faults().loses_every = 3;
  std::string seen;
  while (ring_.sent() % 3 != 0) (void)count();
  for (int i = 0; i < 9; ++i) seen += count() == 1 ? '+' : '-';
  EXPECT_EQ(seen, "++-++-++-");
}

TEST_F(EscRingTest, ACounterComesBackShort) {
  build(3);
  ring_.faults().short_counters = {ring_.sent() + 1};
  EXPECT_EQ(count(), 2);
  EXPECT_EQ(count(), 3);
}

TEST_F(EscRingTest, AFrameComesBackLate) {
  build(1);
  ring_.faults().delay = milliseconds(3);
  const auto frame = frame_of({datagram_of(kBrd, 0, Bytes(2, 0))});
  EXPECT_TRUE(send(frame).empty());
  EXPECT_EQ(ring_.deadline(), now_ + milliseconds(3));
  run(milliseconds(2));
  EXPECT_FALSE(ring_.take_frame());
  run(milliseconds(1));
  EXPECT_TRUE(ring_.take_frame());
  EXPECT_FALSE(ring_.take_frame());
}

TEST_F(EscRingTest, ADamagedFrameIsCountedWhereItCameIn) {
  build(3);
  ring_.faults().damaged[ring_.sent() + 1] = {1, false};
  EXPECT_EQ(datagram(kBwr, 0x0420'0000U, hex("1111")).counter, -1);
  EXPECT_EQ(show(0x0420, 2), "11 11");  // The first had done it.
  EXPECT_EQ(show(0x0420, 2, 0x1002), "E8 03");
  EXPECT_EQ(show(0x0300, 4, 0x1002), "01 00 00 00");
  ring_.faults().damaged[ring_.sent() + 1] = {2, true};
  EXPECT_EQ(datagram(kBwr, 0x0420'0000U, hex("2222")).counter, -1);
  EXPECT_EQ(show(0x0420, 2, kThird), "22 22");
  EXPECT_EQ(show(0x0300, 4, 0x1002), "01 00 01 00");
  EXPECT_EQ(datagram(kBwr, 0x0300'0000U, Bytes(8, 0)).counter, 3);
  EXPECT_EQ(show(0x0300, 4, 0x1002), "00 00 00 00");
}

TEST_F(EscRingTest, ThePortsSayWhereACableEnds) {
  build(3);
  // Ports 2 and 3 are closed; of the first two a link, an open loop and a signal.
  EXPECT_EQ(show(0x0110, 2), "33 5A");
  EXPECT_EQ(show(0x0110, 2, kThird), "13 56");
  ring_.cut_cable(2);
  EXPECT_EQ(count(), 2);
  EXPECT_EQ(show(0x0110, 2, 0x1002), "13 56");
  EXPECT_EQ(show(0x0310, 4, 0x1002), "00 01 00 00");
  EXPECT_EQ(read(0x0110, 2, kThird).counter, 0);
  ring_.join_cable(2);
  EXPECT_EQ(count(), 3);
  EXPECT_EQ(show(0x0110, 2, 0x1002), "33 5A");
  EXPECT_EQ(show(0x0310, 4, kThird), "01 00 00 00");
  EXPECT_EQ(show(0x0010, 2, kThird), "03 10");  // It kept its power and its address.
  EXPECT_EQ(write(0x0310, "00", kThird), 1);
  EXPECT_EQ(show(0x0310, 4, kThird), "00 00 00 00");
  ring_.cut_cable(0);
  EXPECT_EQ(count(), -1);
}

TEST_F(EscRingTest, BehindASlaveWithoutPowerNobodyIsHeard) {
  build(3);
  ring_.power_off(1);
  EXPECT_EQ(count(), 1);
  EXPECT_EQ(show(0x0110, 2), "13 56");
  EXPECT_EQ(slave(2).registers().memory().word(0x0110), 0x5503);  // No link at all.
  ring_.power_on(1, now_);
  EXPECT_EQ(count(), 3);
  EXPECT_EQ(read(0x0010, 2, 0x1002).counter, 0);
  EXPECT_EQ(show(0x0010, 2, kThird), "03 10");
  EXPECT_EQ(to_hex(datagram(kAprd, 0x0010'FFFF, Bytes(2, 0)).data), "00 00");
}

TEST_F(EscRingTest, ASlaveBehindACutCableMissesItsMaster) {
  build(2);
  for (const std::uint16_t station : {std::uint16_t{0x1001}, std::uint16_t{0x1002}}) {
    go_to_pre_op(station);
    for (const auto* request : {"2B 121C 01 0217 0000", "2F 121C 00 01000000"})
      EXPECT_EQ(sdo(request, station).substr(6, 2), "60");
    EXPECT_EQ(write(0x0810, "0018 1300 64 00 01 00", station), 1);
    EXPECT_EQ(request(4, station), "04 00 00 00 00 00");
    EXPECT_EQ(write(0x1800, Bytes(19, 0), station), 1);
    EXPECT_EQ(request(8, station), "08 00 00 00 00 00");
  }
  ring_.cut_cable(1);
  for (int i = 0; i < 30; ++i) {
    run(milliseconds(4));
    EXPECT_EQ(write(0x1800, Bytes(19, 0)), 1);
  }
  EXPECT_EQ(slave(0).state(), EscState::op);
  EXPECT_EQ(slave(1).state(), EscState::safe_op);
  EXPECT_EQ(slave(1).al_code(), 0x001B);
  ring_.join_cable(1);
  EXPECT_EQ(al(0x1002), "14 00 00 00 1B 00");
  // What all say together: the states are added up.
  EXPECT_EQ(to_hex(datagram(kBrd, 0x0130'0000U, Bytes(2, 0)).data), "1C 00");
}

}  // namespace
}  // namespace servoctl::sim
