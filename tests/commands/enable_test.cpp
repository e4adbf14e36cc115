// `enable`, while another master is on the bus.
#include <gtest/gtest.h>

#include <string>

#include "canopen/nmt.hpp"
#include "session/can_network.hpp"
#include "tested_drive.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

class Enable : public TestedDrive, public testing::WithParamInterface<const char*> {
 protected:
  /// RPDO1, whose CAN-ID is 201h, holds this object of 32 bits alone.
  void map(std::uint16_t index) {
    write({0x1400, 1}, 0x8000'0201, 4);
    write({0x1600, 0}, 0, 1);
    write({0x1600, 1}, std::uint64_t{index} << 16U | 32, 4);
    write({0x1600, 0}, 1, 1);
    write({0x1400, 1}, 0x201, 4);
    ASSERT_TRUE(session->can()->send(canopen::nmt_frame(canopen::NmtCommand::start, 1)));
    // Behind each answer of the drive.
    bus->on_receive = [this](const can::Frame& frame) {
      if (frame.id == 0x581) bus->injected.push_back(*can::parse_frame("201#10270000"));
    };
  }

 private:
  void write(ObjectAddress object, std::uint64_t value, std::size_t size) {
    const auto done = session->download(1, object, store_le(value, size));
    ASSERT_TRUE(done) << done.error().message.text();
  }
};

TEST_P(Enable, APdoOfAnotherMasterThatCommandsTheDriveKeepsItFromBeingEnabled) {
  build(std::string(GetParam()) + "@1", GetParam());
  map(0x60FF);
  (void)run("enable");
  ASSERT_FALSE(context.errors.empty());
  EXPECT_EQ(context.errors.front().message.text(),
            "another master sends PDOs with object 0x60FF:0: the drive was not enabled");
  EXPECT_FALSE(drive::is_energised(drive().power_state()));
}

TEST_P(Enable, OneThatHoldsNothingOfTheMotionDoesNot) {
  build(std::string(GetParam()) + "@1", GetParam());
  map(0x6081);
  (void)run("enable");
  EXPECT_TRUE(context.errors.empty()) << context.errors.front().message.text();
  EXPECT_TRUE(drive::is_energised(drive().power_state()));
}

INSTANTIATE_TEST_SUITE_P(Families, Enable, testing::Values("gsd600", "ts"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace servoctl::commands
