// Drive models by themselves: what goes wrong, and what they tell of it.
#include "drive_model_support.hpp"

#include "canopen/sdo_abort.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;
namespace abort = canopen::sdo_abort;

class FaultsOf : public DriveModelOf {};

TEST_P(FaultsOf, TellsAFaultOnceAsAnEmergency) {
  enable();
  EXPECT_EQ(told(), std::vector<Emergency>());
  model().raise_fault(0x3210, {1, 2, 3, 4, 5}, now_);
  EXPECT_TRUE(model().has_emergency());
  EXPECT_EQ(told(), (std::vector<Emergency>{{0x3210, 0x05, {1, 2, 3, 4, 5}}})) << "generic and voltage";
  EXPECT_FALSE(model().has_emergency());
  EXPECT_EQ(number(objects::kErrorRegister), 0x05U);
  EXPECT_EQ(state(), DriveState::fault_reaction_active);
  run(50ms);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_EQ(told(), std::vector<Emergency>());
}

TEST_P(FaultsOf, RaisesAPlannedFaultAtItsTime) {
  model().raise_fault_at({0x2310, {}}, now_ + 500ms);
  EXPECT_EQ(model().deadline(), now_ + 500ms);
  run(499ms);
  EXPECT_EQ(told(), std::vector<Emergency>());
  run(1ms);
  EXPECT_EQ(told(), (std::vector<Emergency>{{0x2310, 0x03, {}}}));
  EXPECT_EQ(model().power_state(), DriveState::fault_reaction_active);
}

TEST_P(FaultsOf, HasNoPowerLeftWhenItsMasterIsLost) {
  constexpr std::uint64_t kFault = 1;
  if (has(objects::kAbortConnectionOption)) {
    ASSERT_EQ(write(objects::kAbortConnectionOption, kFault), 0U);
  }
  enable();
  ASSERT_EQ(write(kTargetVelocity, 100), 0U);
  run(500ms);
  model().on_master_lost(0x8130, now_);
  EXPECT_EQ(told(), (std::vector<Emergency>{{0x8130, 0x11, {}}})) << "generic and communication";
  run(50ms);
  EXPECT_EQ(state(), DriveState::fault);
}

TEST_P(FaultsOf, LosesItsPowerWithTheProcessDataWhereItsRulesSaySo) {
  model().set_operational(true);
  enable();
  model().set_operational(false);
  const bool off = profile_->rules.nmt.disables_outside_operational;
  EXPECT_EQ(off, std::string(GetParam()) == "da200") << "147";
  EXPECT_EQ(state(), off ? DriveState::switch_on_disabled : DriveState::operation_enabled);
}

INSTANTIATE_TEST_SUITE_P(Families, FaultsOf, testing::ValuesIn(kFamilies), family_of);

TEST_F(DriveModelTest, AFaultThatIsResetIsToldAsOver) {
  build("cia402");
  model().raise_fault(0x3210, {}, now_);
  run(50ms);
  (void)told();
  ASSERT_EQ(write(objects::kControlword, 0x80), 0U);
  EXPECT_EQ(told(), (std::vector<Emergency>{{0, 0, {}}}));
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
}

TEST_F(DriveModelTest, AnOptionOfItsMakerSaysWhatALostMasterMeans) {  // 6007h
  build("cia402");
  const std::pair<std::uint64_t, DriveState> options[] = {{0, DriveState::operation_enabled},
                                                          {2, DriveState::switch_on_disabled},
                                                          {3, DriveState::quick_stop_active}};
  for (const auto& [option, end] : options) {
    model().power_on(now_);
    ASSERT_EQ(write(objects::kAbortConnectionOption, option), 0U);
    enable();
    model().on_master_lost(0x8130, now_);
    EXPECT_EQ(state(), end) << option;
    EXPECT_EQ(told().size(), 1U);
    EXPECT_TRUE(model().has_error(ErrorLog::Source::master));
    model().end_error(ErrorLog::Source::master);
    EXPECT_EQ(told(), (std::vector<Emergency>{{0, 0, {}}}));
    model().end_error(ErrorLog::Source::master);
    EXPECT_FALSE(model().has_emergency()) << "told already";
  }
}

TEST_F(DriveModelTest, AWrongAccessIsAnAlarmWhereItsManualSaysSo) {  // 1088
  build("da200");
  EXPECT_EQ(write(objects::kStatusword, 0), abort::kReadOnly);
  const auto alarms = told();
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_EQ(alarms.front().vendor[0], 0x1A);
  EXPECT_EQ(alarms.front().vendor[1], 0x05);
}

TEST_F(DriveModelTest, AnObjectThatOneDriveLacksIsAnAlarmToo) {  // 1084
  for (const bool reads : {true, false}) {
    build("da200");
    model().misbehaviour().missing = {objects::kStatusword.index};
    Bytes out;
    EXPECT_EQ(reads ? model().read(objects::kStatusword, out) : write(objects::kStatusword, 0),
              abort::kNoObject);
    const auto alarms = told();
    ASSERT_EQ(alarms.size(), 1U);
    EXPECT_EQ(alarms.front().vendor[0], 0x1A);
    EXPECT_EQ(alarms.front().vendor[1], 0x01);
  }
}

TEST_F(DriveModelTest, MisbehavesAsItIsToldWithoutAWire) {
  build("cia402");
  Bytes out;
  model().misbehaviour().missing = {0x60FF};
  EXPECT_EQ(model().read(kTargetVelocity, out), abort::kNoObject);
  model().misbehaviour() = {};
  model().misbehaviour().feigned = {0x60FF};
  EXPECT_EQ(write(kTargetVelocity, 5), 0U);
  EXPECT_EQ(number(kTargetVelocity), 0U);
  model().misbehaviour() = {};
  model().misbehaviour().ignores_disable = true;
  enable();
  EXPECT_EQ(write(objects::kControlword, 0), 0U);
  EXPECT_EQ(state(), DriveState::operation_enabled);
}

}  // namespace
}  // namespace servoctl::sim
