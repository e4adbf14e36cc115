// Drive models by themselves: objects, memory, CiA 402 states, motion; no frame is made here.
#include "drive_model_support.hpp"

#include "canopen/sdo_abort.hpp"
#include "drive/quantity.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;
namespace abort = canopen::sdo_abort;

constexpr ObjectAddress kMapping{0x1A00, 0};

TEST_P(DriveModelOf, TellsWhoItIs) {
  for (const auto& mark : profile_->rules.identity) {
    const auto value = read(mark.object);
    if (mark.text.empty()) {
      EXPECT_EQ(load_le(value) & mark.mask, mark.value & mark.mask) << to_string(mark.object);
    } else {
      EXPECT_EQ(std::string(value.begin(), value.end()), mark.text);
    }
  }
  Bytes out;
  for (const ObjectAddress object : {objects::kDeviceType, objects::kDeviceName, objects::kVendorId})
    EXPECT_EQ(model().read(object, out), has(object) ? 0U : abort::kNoObject) << to_string(object);
}

TEST_P(DriveModelOf, GivesBackWhatWasWritten) {
  for (const std::uint64_t value : {1000U, 0U, 77U}) {
    EXPECT_EQ(write(kTargetVelocity, value), 0U);
    EXPECT_EQ(number(kTargetVelocity), value);
  }
}

TEST_P(DriveModelOf, RefusesWithAnAbortCodeAndChangesNothing) {
  ASSERT_EQ(write(kTargetVelocity, 1000), 0U);
  EXPECT_EQ(write(objects::kStatusword, 0), abort::kReadOnly);
  EXPECT_EQ(model().check_writable(objects::kStatusword), abort::kReadOnly);
  const auto limits = drive::meaning(drive::target_at(profile_.get(), objects::kModeOfOperation), 1);
  EXPECT_EQ(write(objects::kModeOfOperation, 99), limits.max ? abort::kTooHigh : abort::kRange);
  const auto wrong_length = profile_->rules.sdo.exact_length ? abort::kLength : abort::kTooShort;
  EXPECT_EQ(model().write(kTargetVelocity, store_le(1, 2)), wrong_length);
  EXPECT_EQ(number(kTargetVelocity), 1000U);
  Bytes out;
  EXPECT_EQ(model().read({0x5FFF, 0}, out), abort::kNoObject);
  EXPECT_EQ(model().read({0x1018, 200}, out), abort::kNoSubIndex);
}

TEST_P(DriveModelOf, KeepsOverAPowerCycleWhatWentToItsMemoryAlone) {
  ASSERT_EQ(write(kTargetVelocity, 1000), 0U);
  const auto before = model().flash_writes();
  power_cycle();
  EXPECT_EQ(number(kTargetVelocity), 0U);
  EXPECT_EQ(model().flash_writes(), before);
  if (!has(objects::kStoreAll)) return;
  ASSERT_EQ(write(kTargetVelocity, 1000), 0U);
  EXPECT_EQ(write(objects::kStoreAll, 1), abort::kCannotStore) << "not its signature";
  EXPECT_EQ(write(objects::kStoreAll, objects::kSaveSignature), 0U);
  power_cycle();
  EXPECT_EQ(number(kTargetVelocity), 1000U);
  EXPECT_EQ(write(objects::kRestoreAll, objects::kLoadSignature), 0U);
  EXPECT_EQ(number(kTargetVelocity), 1000U) << "not before the start";
  power_cycle();
  EXPECT_EQ(number(kTargetVelocity), 0U);
}

TEST_P(DriveModelOf, GoesThroughTheStatesOfCia402) {
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
  const std::pair<unsigned, DriveState> steps[] = {{6, DriveState::ready_to_switch_on},
                                                   {7, DriveState::switched_on},
                                                   {15, DriveState::operation_enabled},
                                                   {7, DriveState::switched_on},
                                                   {0, DriveState::switch_on_disabled}};
  for (const auto& [word, reached] : steps) {
    ASSERT_EQ(write(objects::kControlword, word), 0U);
    run(5ms);
    EXPECT_EQ(state(), reached) << word;
    EXPECT_EQ(model().power_state(), reached);
  }
}

TEST_P(DriveModelOf, QuickStopTakesItsTime) {
  enable();
  ASSERT_EQ(write(objects::kControlword, 2), 0U);
  EXPECT_EQ(state(), DriveState::quick_stop_active);
  EXPECT_NE(model().deadline(), kNever);
  run(1ms);
  EXPECT_EQ(state(), DriveState::quick_stop_active);
  model().on_time(model().deadline());
  EXPECT_EQ(model().deadline(), kNever);
}

TEST_P(DriveModelOf, JogsByItsTargetVelocity) {
  const auto start = amount(objects::kPositionActual);
  enable();
  run(100ms);
  EXPECT_EQ(amount(objects::kPositionActual), start) << "nobody asked";
  ASSERT_EQ(write(kTargetVelocity, 100), 0U);
  run(2s);
  EXPECT_TRUE(model().is_moving());
  EXPECT_GT(amount(objects::kVelocityActual), 0);
  EXPECT_GT(amount(objects::kPositionActual), start);
  ASSERT_EQ(write(kTargetVelocity, 0), 0U);
  run(2s);
  EXPECT_FALSE(model().is_moving());
  EXPECT_EQ(amount(objects::kVelocityActual), 0);
  const auto end = amount(objects::kPositionActual);
  run(1s);
  EXPECT_EQ(amount(objects::kPositionActual), end);
}

TEST_P(DriveModelOf, TakesAMappingOfWhatItCanExchangeOnly) {
  if (!has({0x1A00, 1}) || write(kMapping, 0) != 0) GTEST_SKIP() << "what TPDO1 carries is fixed";
  EXPECT_EQ(write({0x1A00, 1}, 0x6041'0010), 0U);
  EXPECT_EQ(write({0x1A00, 1}, 0x6041'0020), abort::kNotMappable) << "16 bits";
  EXPECT_EQ(write({0x1A00, 1}, 0x5FFF'0010), abort::kNoObject);
  EXPECT_EQ(write(kMapping, 1), 0U);
}

INSTANTIATE_TEST_SUITE_P(Families, DriveModelOf, testing::ValuesIn(kFamilies), family_of);

TEST_F(DriveModelTest, APanelParameterIsKeptAtOnceAndOneForTheNextStartTakesEffectThen) {
  build("gsd600");
  const auto id = profile_->parameter("Pn0116")->object.value();  // Heartbeat time.
  const auto mirror = objects::kProducerHeartbeat;
  ASSERT_EQ(write(id, 200), 0U);
  EXPECT_EQ(model().flash_writes(), 1U);
  EXPECT_EQ(model().setting("Pn0116"), 0U);
  EXPECT_EQ(number(mirror), 0U);
  model().reset_communication(now_);
  EXPECT_EQ(number(mirror), 0U);
  power_cycle();
  EXPECT_EQ(model().setting("Pn0116"), 200U);
  EXPECT_EQ(number(mirror), 200U);
  EXPECT_EQ(model().setting("Pn9999"), std::nullopt);
  EXPECT_EQ(model().setting(""), std::nullopt);
}

TEST_F(DriveModelTest, AResetOfTheCommunicationLeavesStateAndMotionAlone) {
  build("cia402");
  enable();
  ASSERT_EQ(write(kTargetVelocity, 100), 0U);
  ASSERT_EQ(write(objects::kProducerHeartbeat, 500), 0U);
  run(1s);
  model().reset_communication(now_);
  EXPECT_EQ(number(objects::kProducerHeartbeat), 0U);
  EXPECT_EQ(number(kTargetVelocity), 100U);
  EXPECT_EQ(state(), DriveState::operation_enabled);
  EXPECT_TRUE(model().is_moving());
}

/// Lets nobody change the heartbeat.
class NoHeartbeat final : public DrivePort {
 public:
  std::uint32_t check_write(ObjectAddress object, ByteSpan /*data*/) const override {
    return object == objects::kProducerHeartbeat ? abort::kLocalControl : 0;
  }
  void on_written(ObjectAddress object) override { written.push_back(object); }

  std::vector<ObjectAddress> written;
};

TEST_F(DriveModelTest, ItsPortIsAskedBeforeAWriteAndHearsOfItAfterwards) {
  NoHeartbeat port;
  build("cia402");
  model().attach(port);
  EXPECT_EQ(write(objects::kProducerHeartbeat, 500), abort::kLocalControl);
  EXPECT_EQ(number(objects::kProducerHeartbeat), 0U);
  EXPECT_EQ(write(kTargetVelocity, 5), 0U);
  EXPECT_EQ(write(objects::kModeOfOperation, 99), abort::kRange);
  EXPECT_EQ(port.written, std::vector<ObjectAddress>{kTargetVelocity});
}

}  // namespace
}  // namespace servoctl::sim
