// A quick stop slows the motor down by the ramp that 605Ah names, and takes the time of that ramp.
#include "drive/quantity.hpp"
#include "drive_model_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

constexpr ObjectAddress kOption{0x605A, 0};
constexpr ObjectAddress kDeceleration{0x6084, 0};
constexpr ObjectAddress kQuickStopDeceleration{0x6085, 0};

class QuickStop : public DriveModelTest {
 protected:
  /// Turns at a steady speed, with 605Ah and ramps that stop it in `slow` and `quick` seconds.
  void turn(unsigned option, double speed, double slow, double quick) {
    EXPECT_EQ(has(kOption) ? write(kOption, option) : 0U, 0U);
    EXPECT_EQ(has(kDeceleration) ? write_amount(kDeceleration, speed / slow) : 0U, 0U);
    EXPECT_EQ(has(kQuickStopDeceleration) ? write_amount(kQuickStopDeceleration, speed / quick) : 0U, 0U);
    enable();
    ASSERT_EQ(write_amount(kTargetVelocity, speed), 0U);
    run(10s);
    ASSERT_TRUE(model().is_moving());
  }
  std::uint32_t write_amount(ObjectAddress object, double value) {
    const auto& meaning = drive::meaning(drive::target_at(profile_.get(), object), 1);
    const auto raw = meaning.encoding == od::Encoding::plain
                         ? od::Value(static_cast<std::int64_t>(value / meaning.scale))
                         : od::encode_number(meaning.encoding, meaning.type, value).value();
    return model().write(object, od::encode(meaning.type, raw).value());
  }
  /// From 02h until the motor is at rest.
  Duration stop() {
    const auto begin = now_;
    EXPECT_EQ(write(objects::kControlword, 0x02), 0U);
    EXPECT_EQ(state(), DriveState::quick_stop_active);
    while (model().is_moving() && now_ < begin + 10s) run(1ms);
    return now_ - begin;
  }
  void expect_near(Duration took, Duration wanted) {
    EXPECT_GE(took, wanted - 20ms);
    EXPECT_LE(took, wanted + 20ms);
  }
};

TEST_F(QuickStop, TakesTheTimeOf6085hAndEndsDisabled) {
  build("gsd600");
  turn(2, 1'310'720, 5, 0.5);
  expect_near(stop(), 500ms);
  run(30ms);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
}

TEST_F(QuickStop, StaysActiveAsLongAsItSlowsDown) {
  build("gsd600");
  turn(2, 1'310'720, 5, 1);
  EXPECT_EQ(write(objects::kControlword, 0x02), 0U);
  run(900ms);
  EXPECT_EQ(state(), DriveState::quick_stop_active);
  EXPECT_TRUE(model().is_moving());
  EXPECT_EQ(write(objects::kControlword, 0x0F), 0U);
  EXPECT_EQ(state(), DriveState::quick_stop_active) << "0Fh counts only after the stop (6493)";
  run(200ms);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
}

TEST_F(QuickStop, HoldsTheMotorWhereTheOptionSaysSo) {
  build("gsd600");
  turn(6, 1'310'720, 5, 0.5);
  expect_near(stop(), 500ms);
  run(5s);
  EXPECT_EQ(state(), DriveState::quick_stop_active);
  EXPECT_FALSE(model().is_moving()) << "60FFh is not followed";
  EXPECT_EQ(write(objects::kControlword, 0x0F), 0U);
  EXPECT_EQ(state(), DriveState::operation_enabled);
}

TEST_F(QuickStop, WithoutARampLetsTheMotorGoAtOnce) {
  build("gsd600");
  turn(0, 1'310'720, 5, 1);
  EXPECT_LE(stop(), 2ms) << "605Ah = 0 disables at once (5422)";
}

TEST_F(QuickStop, OfTheDmHasTheTwoRampsOfItsTable) {
  struct Row {
    unsigned option;
    Duration wanted;
    DriveState end;
  };
  for (const auto& row :
       {Row{1, 1s, DriveState::switch_on_disabled}, Row{2, 500ms, DriveState::switch_on_disabled},
        Row{3, 1s, DriveState::quick_stop_active}, Row{4, 500ms, DriveState::quick_stop_active}}) {
    SCOPED_TRACE(row.option);
    build("dm");
    turn(row.option, 10, 1, 0.5);
    expect_near(stop(), row.wanted);
    run(50ms);
    EXPECT_EQ(state(), row.end);
  }
}

TEST_F(QuickStop, OfTheSv2Uses6085hFor1And5) {
  for (const auto option : {1U, 5U}) {
    SCOPED_TRACE(option);
    build("sv2");
    turn(option, 100'000, 5, 0.5);
    expect_near(stop(), 500ms);
    run(50ms);
    EXPECT_EQ(state(), option == 1 ? DriveState::switch_on_disabled : DriveState::quick_stop_active);
  }
}

TEST_F(QuickStop, OfCia402TakesSlowDownOrQuickStopRamp) {
  for (const auto option : {1U, 2U, 5U, 6U}) {
    SCOPED_TRACE(option);
    build("cia402");
    turn(option, 100'000, 1, 0.5);
    expect_near(stop(), option == 1 || option == 5 ? 1s : 500ms);
    run(50ms);
    EXPECT_EQ(state(), option < 5 ? DriveState::switch_on_disabled : DriveState::quick_stop_active);
  }
}

TEST_F(QuickStop, OfDrivesWithout605AhTakesTheRampThatTheyHave) {
  build("da200");  // 6085h is a time in ms, that from 3000 rpm.
  enable();
  ASSERT_EQ(write(kQuickStopDeceleration, 30'000), 0U);
  ASSERT_EQ(write_amount(kTargetVelocity, 100), 0U);
  run(20s);
  EXPECT_GT(stop(), 300ms);
  build("ts");
  turn(0, 300, 1, 1);
  expect_near(stop(), 30ms);  // 300 rpm by 6084h = 300 ms (assumed).
}

TEST_F(QuickStop, WithTheMostTorqueTakesTime) {
  for (const auto& [family, options] :
       {std::pair{"cia402", std::vector{3U, 4U, 7U, 8U}}, std::pair{"sv2", std::vector{2U, 6U}}})
    for (const auto option : options) {
      SCOPED_TRACE(family);
      build(family);
      turn(option, 1'000'000, 5, 5);
      const auto took = stop();
      EXPECT_GT(took, 1ms) << option;
      EXPECT_LT(took, 5s) << option;
    }
}

TEST_F(QuickStop, ByARampThatNeverEndsStaysActive) {
  build("gsd600");
  turn(2, 1'310'720, 5, 5);
  ASSERT_EQ(write(kQuickStopDeceleration, 0), 0U);
  EXPECT_GE(stop(), 10s) << "0 counts as 1 inc/s² (5992)";
  build("dm");
  turn(2, 10, 5, 5);
  ASSERT_EQ(write(kQuickStopDeceleration, 1), 0U) << "the least float above 0";
  EXPECT_GE(stop(), 10s);
  EXPECT_EQ(state(), DriveState::quick_stop_active);
}

TEST_F(QuickStop, EndsWithAFault) {
  build("gsd600");
  turn(2, 1'310'720, 5, 5);
  EXPECT_EQ(write(objects::kControlword, 0x02), 0U);
  run(100ms);
  model().raise_fault(0x8611, {}, now_);
  run(50ms);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_FALSE(model().is_moving());
}

TEST_F(QuickStop, IsCutShortByDisableVoltage) {
  build("gsd600");
  turn(2, 1'310'720, 5, 5);
  EXPECT_EQ(write(objects::kControlword, 0x02), 0U);
  run(100ms);
  EXPECT_EQ(write(objects::kControlword, 0x00), 0U);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
}

TEST_F(QuickStop, AFaultOfTheDmSlowsDownBy6085h) {
  build("dm");
  turn(2, 10, 5, 1);
  model().raise_fault(0x8611, {}, now_);
  run(900ms);
  EXPECT_EQ(state(), DriveState::fault_reaction_active) << "line 132";
  EXPECT_TRUE(model().is_moving());
  run(200ms);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_FALSE(model().is_moving());
}

}  // namespace
}  // namespace servoctl::sim
