// Process data of a simulated drive on EtherCAT: assignment, images, motion.
#include "esc_process_data_support.hpp"

namespace servoctl::sim {
namespace {

using std::chrono::milliseconds;

TEST_F(EscProcessDataTest, EveryFixedPdoHasTheLengthThatItsObjectsMake) {
  build(1);
  go_to_pre_op();
  struct Row {
    const char* assign;
    std::size_t size;
  };
  const Row outputs[] = {{"0117", 12}, {"0217", 19}, {"0317", 17}, {"0417", 23}, {"0517", 19}};
  const Row inputs[] = {{"011B", 28}, {"021B", 25}, {"031B", 29}, {"041B", 29}};
  for (const auto& row : outputs) {
    EXPECT_EQ(sdo("2F 121C 00 00000000").substr(6, 2), "60");
    EXPECT_EQ(sdo(std::string("2B 121C 01 ") + row.assign + "0000").substr(6, 2), "60");
    EXPECT_EQ(sdo("2F 121C 00 01000000").substr(6, 2), "60");
    EXPECT_EQ(write(0x0816, "00"), 1);
    auto settings = hex("0018 0000 64 00 01 00");
    settings[2] = static_cast<std::uint8_t>(row.size);
    EXPECT_EQ(write(0x0810, settings), 1);
    EXPECT_EQ(request(0x14), "04 00 00 00 00 00") << row.assign;
    EXPECT_EQ(request(2), "02 00 00 00 00 00");
  }
  for (const auto& row : inputs) {
    EXPECT_EQ(sdo("2F 131C 00 00000000").substr(6, 2), "60");
    EXPECT_EQ(sdo(std::string("2B 131C 01 ") + row.assign + "0000").substr(6, 2), "60");
    EXPECT_EQ(sdo("2F 131C 00 01000000").substr(6, 2), "60");
    EXPECT_EQ(write(0x081E, "00"), 1);
    auto settings = hex("001C 0000 20 00 01 00");
    settings[2] = static_cast<std::uint8_t>(row.size);
    EXPECT_EQ(write(0x0818, settings), 1);
    EXPECT_EQ(request(0x14), "04 00 00 00 00 00") << row.assign;
    EXPECT_EQ(request(2), "02 00 00 00 00 00");
  }
}

TEST_F(EscProcessDataTest, AssignmentsChangeInPreOpAndOnlyToWhatIsThere) {
  build(1);
  go_to_pre_op();
  EXPECT_EQ(sdo("2F 121C 00 01000000").substr(18), "42 00 04 06");  // Nothing stands there yet.
  EXPECT_EQ(sdo("2F 121C 00 02000000").substr(18), "42 00 04 06");
  EXPECT_EQ(sdo("2B 121C 01 041B 0000").substr(18), "30 00 09 06");  // Of the other direction.
  EXPECT_EQ(sdo("2B 121C 01 0617 0000").substr(18), "30 00 09 06");
  EXPECT_EQ(sdo("2B 121C 01 0217 0000").substr(6, 2), "60");
  EXPECT_EQ(sdo("2F 121C 00 01000000").substr(6, 2), "60");
  EXPECT_EQ(sdo("2B 121C 01 0117 0000").substr(18), "03 00 01 06");  // It is open.
  EXPECT_EQ(sdo("23 0217 01 10004060").substr(18), "02 00 01 06");
  EXPECT_EQ(write(0x0810, "0018 1300 64 00 01 00"), 1);
  ASSERT_EQ(request(4), "04 00 00 00 00 00");
  EXPECT_EQ(sdo("2F 121C 00 00000000").substr(18), "22 00 00 08");
  EXPECT_EQ(sdo("2F 001A 00 00000000").substr(18), "22 00 00 08");
}

TEST_F(EscProcessDataTest, AMappingOfOnesOwnIsTaken) {
  build(1);
  go_to_pre_op();
  for (const auto* request : {"2F 0016 00 00000000", "23 0016 01 10004060", "23 0016 02 08006060",
                              "2F 0016 00 02000000", "2B 121C 01 0016 0000", "2F 121C 00 01000000"})
    EXPECT_EQ(sdo(request).substr(6, 2), "60") << request;
  EXPECT_EQ(write(0x0810, "0018 0300 64 00 01 00"), 1);
  ASSERT_EQ(request(4), "04 00 00 00 00 00");
  EXPECT_EQ(write(0x1800, "0600 03"), 1);
  ASSERT_EQ(request(8), "08 00 00 00 00 00");
  EXPECT_EQ(sdo("40 6160 00 00000000").substr(18), "03 00 00 00");
  EXPECT_EQ(sdo("40 4160 00 00000000").substr(18, 2), "31");
}

TEST_F(EscProcessDataTest, ASubIndexIsReachedByItsMapping) {
  build(1);
  go_to_pre_op();
  for (const auto* request : {"2B 121C 01 0117 0000", "2F 121C 00 01000000"})
    EXPECT_EQ(sdo(request).substr(6, 2), "60") << request;
  EXPECT_EQ(write(0x0810, "0018 0C00 64 00 01 00"), 1);
  ASSERT_EQ(request(4), "04 00 00 00 00 00");
  EXPECT_EQ(write(0x1800, "0000 00000000 0000 00000300"), 1);
  ASSERT_EQ(request(8), "08 00 00 00 00 00");
  EXPECT_EQ(slave().model().values().number({0x60FE, 1}), 0x0003'0000U);
}

TEST_F(EscProcessDataTest, InSafeOpInputsAreValidAndOutputsDoNothing) {
  start();
  out.controlword = 6;
  EXPECT_EQ(exchange(), 3);
  EXPECT_EQ(in_.size(), 29U);
  EXPECT_EQ(statusword(), 0x0250U);
  cycle(10 * kCycle);
  EXPECT_EQ(statusword(), 0x0250U);
  EXPECT_EQ(datagram(kLrd, 0x0001'0013, Bytes(29, 0)).counter, 1);
  EXPECT_EQ(datagram(kLwr, 0x0001'0000, Bytes(19, 0)).counter, 1);
}

TEST_F(EscProcessDataTest, TheImageThatLiesThereIsTakenOverWhenOpBegins) {
  start();
  out.controlword = 6;
  EXPECT_EQ(exchange(), 3);
  ASSERT_EQ(request(8), "08 00 00 00 00 00");
  out.controlword = 0;
  EXPECT_EQ(exchange(), 3);
  EXPECT_EQ(statusword() & 0x6FU, 0x21U);
}

TEST_F(EscProcessDataTest, JogsByItsImageAndStops) {
  start();
  preset();
  EXPECT_EQ(exchange(), 3);
  ASSERT_EQ(request(8), "08 00 00 00 00 00");
  enable();
  cycle(milliseconds(100));
  EXPECT_EQ(velocity(), 0);
  const auto begin = position();
  out.velocity = 20000;  // Two turns a second.
  cycle(milliseconds(1000));
  EXPECT_NEAR(velocity(), 20000, 200);
  EXPECT_GT(position() - begin, 5000);
  out.velocity = 0;
  cycle(milliseconds(1000));
  EXPECT_EQ(velocity(), 0);
  const auto end = position();
  out.controlword = 0;
  cycle(milliseconds(100));
  EXPECT_EQ(statusword() & 0x4FU, 0x40U);
  EXPECT_EQ(position(), end);
}

TEST_F(EscProcessDataTest, AnImageOfZerosWritesZerosIntoTheObjectsThatItCarries) {
  build(1);
  const auto before = slave().model().values().number({0x607F, 0});
  ASSERT_NE(before, 0U);
  slaves_.clear();
  ring_ = {};
  start_op();
  EXPECT_EQ(slave().model().values().number({0x607F, 0}), 0U);
}

TEST_F(EscProcessDataTest, OutputsInTwoDatagramsAreTakenOverTogether) {
  start_op();
  EXPECT_EQ(write(0x1800, "0600"), 1);
  EXPECT_EQ(sdo("40 4060 00 00000000").substr(18, 2), "00");
  EXPECT_EQ(write(0x1802, Bytes(17, 0)), 1);
  EXPECT_EQ(sdo("40 4060 00 00000000").substr(18, 2), "06");
}

}  // namespace
}  // namespace servoctl::sim
