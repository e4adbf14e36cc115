// PDOs of another master that reach the drive in a motion.
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

struct Case {
  const char* family;
  double turn;
};

class ForeignPdo : public testing::TestWithParam<Case> {
 protected:
  MotionBench bench{GetParam().family, GetParam().turn};

  void write(std::uint16_t index, std::uint8_t sub, std::uint64_t value, std::size_t size) {
    const auto done = bench.session->download(1, {index, sub}, store_le(value, size));
    ASSERT_TRUE(done) << done.error().message.text();
  }
  /// RPDO1 holds this object alone; its CAN-ID is 201h.
  void map(std::uint16_t index, unsigned bits) {
    write(0x1400, 1, 0x8000'0201, 4);
    write(0x1600, 0, 0, 1);
    write(0x1600, 1, std::uint64_t{index} << 16U | bits, 4);
    write(0x1600, 0, 1, 1);
    write(0x1400, 1, 0x201, 4);
  }
  void order(canopen::NmtCommand command) {
    ASSERT_TRUE(bench.session->can()->send(canopen::nmt_frame(command, 1)));
    bench.wait(10ms);
  }
  /// The frame arrives when the motion has gone on for some samples.
  void send_meanwhile(const char* frame) {
    bench.options.on_sample = [this, frame](const MotionSample&) {
      if (++samples_ == 3) bench.bus->injected.emplace_back(frame);
    };
  }
  void expect_noticed(const MotionReport& done, std::string_view object) {
    ASSERT_FALSE(done.outcome);
    EXPECT_NE(done.outcome.error().message.text().find("another master sent a PDO with object " +
                                                       std::string(object)),
              std::string::npos)
        << done.outcome.error().message.text();
    EXPECT_FALSE(bench.energised());
  }

 private:
  int samples_ = 0;
};

TEST_P(ForeignPdo, ATargetVelocityEndsAJog) {
  map(0x60FF, 32);
  order(canopen::NmtCommand::start);
  send_meanwhile("201#10270000");
  expect_noticed(bench.jog(jog_for("60rpm", 1s)), "0x60FF:0");
}

TEST_P(ForeignPdo, ATargetPositionEndsAMove) {
  map(0x607A, 32);
  order(canopen::NmtCommand::start);
  send_meanwhile("201#10270000");
  expect_noticed(bench.move(move_to("5rev", "60rpm", true)), "0x607A:0");
}

TEST_P(ForeignPdo, ATargetTorqueEndsATorqueMotion) {
  if (!bench.profile().dictionary.find({0x6071, 0})) GTEST_SKIP() << "it has no torque mode";
  bench.options.speed_limit = "200rpm";
  map(0x6071, 16);
  order(canopen::NmtCommand::start);
  send_meanwhile("201#1027");
  expect_noticed(bench.torque({.torque = "1%", .length = 1s}), "0x6071:0");
}

/// They come before the drive is enabled, and while it is prepared.
TEST_P(ForeignPdo, ATargetThatIsSentAllTheTimeKeepsTheDriveFromBeingEnabled) {
  map(0x60FF, 32);
  order(canopen::NmtCommand::start);
  int enables = 0;
  bench.bus->swallows = [&](const std::string& frame) {
    if (frame.starts_with("601#")) bench.bus->injected.emplace_back("201#10270000");
    enables += frame.starts_with("601#2B4060000F");
    return false;
  };
  const auto done = bench.jog(jog_for("60rpm", 1s));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().message.text(),
            "another master sends PDOs with object 0x60FF:0: the drive was not enabled");
  EXPECT_EQ(enables, 0);
}

TEST_P(ForeignPdo, WhatIsMappedToNothingOfTheMotionEndsNone) {
  map(0x6081, 32);
  order(canopen::NmtCommand::start);
  send_meanwhile("201#10270000");
  const auto done = bench.jog(jog_for("60rpm", 1s));
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
}

/// By what another master could write is not known then.
TEST_P(ForeignPdo, AMappingThatIsNotAnsweredKeepsTheDriveFromBeingEnabled) {
  map(0x60FF, 32);
  bench.bus->swallows = [](const std::string& frame) { return frame.starts_with("601#40001600"); };
  const auto done = bench.jog(jog_for("60rpm", 1s));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::timeout);
  EXPECT_FALSE(bench.energised());
}

/// What a drive without RPDOs does where nobody says that it has some.
TEST_P(ForeignPdo, RpdosThatNobodyListsMayBeMissingInAnyWay) {
  session::ForeignWrites writes(*bench.session, 1, [](auto, auto) {});
  std::size_t asked = 0;
  bench.bus->swallows = [&](const std::string& frame) {
    const bool is_head = frame.starts_with("601#400014");
    asked += is_head ? 1 : 0;
    return is_head;
  };
  EXPECT_TRUE(writes.learn_rpdos(drive::Profile{}));
  EXPECT_EQ(asked, 2U) << "one silent object and its second try tell enough";
  bench.bus->swallows = {};
  bench.bus->alter = [](can::Frame& frame) {
    if (frame.id == 0x581 && frame.data[2] == 0x14) frame.data[0] = 0x20;  // No answer to a read.
  };
  EXPECT_TRUE(writes.learn_rpdos(drive::Profile{}));
  EXPECT_FALSE(writes.learn_rpdos(bench.profile())) << "its data list them";
}

INSTANTIATE_TEST_SUITE_P(Families, ForeignPdo,
                         testing::Values(Case{"cia402", 10000}, Case{"ts", 10000}, Case{"gsd600", 131072}),
                         [](const auto& one) { return std::string(one.param.family); });

}  // namespace
}  // namespace servoctl::motion
