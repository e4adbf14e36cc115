// What is said of a motor that has lost its master is the same before a motion, after it, and by `watchdog`.
#include "motion/lost_master.hpp"

#include "motion/motion_result.hpp"
#include "motion/watchdog_report.hpp"
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

const std::vector<std::filesystem::path> kLostMasterFolders{std::filesystem::path(source_dir()) / "eds"};

class LostMasterOf : public testing::TestWithParam<std::string_view> {};

TEST_P(LostMasterOf, IsToldAlikeBeforeAndAfterAMotionAndByTheCommand) {
  MotionBench bench(GetParam());
  const auto plan = plan_watchdog(*bench.session, bench.profile(), 1, {});
  ASSERT_TRUE(plan) << plan.error().message.text();
  if (plan->kind == WatchdogPlan::Kind::heartbeat) {
    const auto armed = bench.session->download(1, {objects::kConsumerHeartbeatIndex, plan->entry},
                                               store_le(std::uint32_t{plan->producer} << 16U | 500U, 4));
    ASSERT_TRUE(armed) << armed.error().message.text();
  }
  if (plan->reaction_off) {
    ASSERT_TRUE(bench.session->download(1, objects::kAbortConnectionOption, store_le(kReactWithFault, 2)));
  }
  constexpr std::uint8_t kNodes[] = {1};
  const auto report = read_watchdogs(*bench.session, bench.profile(), kNodes).front();
  ASSERT_TRUE(report) << report.error().message.text();

  const bool sure = report->stops == Stops::yes;
  EXPECT_EQ(sure, GetParam() == "cia402");
  EXPECT_EQ(plan->stops(), report->stops);
  EXPECT_EQ(watchdog_item(*plan).weight == PreflightItem::Weight::good, sure);
  MotionEnd lost;
  lost.watched = true;
  const auto text = end_text(lost, *plan);
  EXPECT_EQ(text.find("set to stop it") != std::string::npos, sure) << text;
  EXPECT_EQ(text.find("known") == std::string::npos, sure) << text;
  const auto unwatched = end_text({}, *plan);
  EXPECT_EQ(unwatched.find("watchdog"), std::string::npos) << unwatched;
  EXPECT_NE(unwatched.find("known"), std::string::npos) << unwatched;
}

TEST(LostMasterFacts, OfADriveThatNobodyKnowsAreNotTakenFromTheListOfTheStandard) {
  MotionBench bench("cia402");
  ASSERT_TRUE(bench.session->download(1, objects::kAbortConnectionOption, store_le(0xFFFFU, 2)));
  const auto plan = plan_watchdog(*bench.session, bench.profile(), 1, {});
  ASSERT_TRUE(plan) << plan.error().message.text();
  EXPECT_EQ(plan->stops(), Stops::unknown);
  EXPECT_NE(to_string(*plan).find("6007h = -1 does not tell it"), std::string::npos) << to_string(*plan);
}

TEST(LostMasterFacts, AFaultOfTheMakerTellsNothingBesideAReactionOfTheMaker) {
  LostMaster facts;
  facts.noticed = true;
  facts.fault = true;
  EXPECT_EQ(facts.stops(), Stops::yes);
  facts.option = -1;
  EXPECT_EQ(facts.stops(), Stops::unknown);
}

INSTANTIATE_TEST_SUITE_P(Families, LostMasterOf,
                         testing::Values("cia402", "gsd600", "dm", "ts", "da200", "sv2"),
                         [](const auto& one) { return std::string(one.param); });

TEST(LostMasterFacts, AReactionThatIsTheManufacturersOwnIsNotAStop) {  // CiA 402-2, 6007h
  LostMaster facts{.noticed = true, .option = 3};
  EXPECT_EQ(facts.stops(), Stops::yes);
  facts.option = 4;
  EXPECT_EQ(facts.stops(), Stops::unknown) << "reserved";
  facts.option = -1;
  EXPECT_EQ(facts.stops(), Stops::unknown);
  facts.option = 0;
  EXPECT_EQ(facts.stops(), Stops::no);
}

TEST(LostMasterFacts, WithoutAWatchdogAnAlarmOfTheManualLeavesItOpen) {
  LostMaster facts{.option = 1, .power_off = true, .fault = true};
  EXPECT_EQ(facts.stops(), Stops::no) << "nobody notices";
  facts.alarms = true;
  EXPECT_EQ(facts.stops(), Stops::unknown);
  WatchdogPlan plan;
  EXPECT_EQ(expectation(plan, true), "nothing is known that stops it by itself");
  plan.alarms = {"Er26-b"};
  EXPECT_EQ(expectation(plan, true), "whether it stops by itself is not known");
}

TEST(LostMasterFacts, ADriveThatLeavesOperationalStopsWhereItsPowerGoesWithThat) {
  EXPECT_EQ((LostMaster{.noticed = true, .option = {}, .power_off = true}).stops(), Stops::yes);
  EXPECT_TRUE(leaves_operational(0));
  EXPECT_FALSE(leaves_operational(1));
  EXPECT_TRUE(leaves_operational(2));
}

TEST(LostMasterFacts, TheFaultIsOneOfTheFamilyAndNoWarning) {
  auto family = drive::load_profile("gsd600", kLostMasterFolders).value();
  EXPECT_FALSE(lost_master_fault(family).empty());
  for (auto& fault : family.faults)
    if (fault.code == 0x8130) fault.kind = drive::Fault::Kind::warning;
  EXPECT_EQ(lost_master_fault(family), "");
  EXPECT_EQ(lost_master_fault(drive::load_profile("cia402", kLostMasterFolders).value()), "")
      << "its list is that of the standard";
}

TEST(LostMasterFacts, ThatTheFaultTakesThePowerIsToldBeforeAndByTheCommand) {
  MotionBench bench("gsd600");
  auto family = bench.profile();
  std::erase(family.rules.assumed, "watchdog");
  const auto plan = plan_watchdog(*bench.session, family, 1, {});
  ASSERT_TRUE(plan) << plan.error().message.text();
  EXPECT_EQ(plan->stops(), Stops::yes);
  const auto entry = store_le(std::uint32_t{plan->producer} << 16U | 500U, 4);
  ASSERT_TRUE(bench.session->download(1, {objects::kConsumerHeartbeatIndex, plan->entry}, entry));
  constexpr std::uint8_t kNodes[] = {1};
  EXPECT_EQ(read_watchdogs(*bench.session, family, kNodes).front().value().stops, Stops::yes);
}

/// What is told of a drive whose 6007h is answered so, or not at all.
class UnreadReaction : public testing::Test {
 protected:
  UnreadReaction() {
    profile.rules.nmt.disables_outside_operational = true;
    bench.bus->alter = [this](can::Frame& frame) {
      // An expedited upload response becomes an abort: hardware error.
      const bool is_option = frame.id == 0x581 && frame.data[1] == 0x07 && frame.data[2] == 0x60;
      if (is_option && refuses) frame.data = {0x80, 0x07, 0x60, 0x00, 0x00, 0x00, 0x06, 0x06};
    };
  }
  void set_behaviour(std::uint8_t behaviour) {
    ASSERT_TRUE(bench.session->download(1, objects::kCommunicationErrorBehaviour, store_le(behaviour, 1))
                    .has_value());
  }
  Result<WatchdogPlan> plan() { return plan_watchdog(*bench.session, profile, 1, {}); }
  Stops reported() {
    const auto entry = store_le(std::uint32_t{127} << 16U | 500U, 4);
    EXPECT_TRUE(bench.session->download(1, {objects::kConsumerHeartbeatIndex, 1}, entry));
    constexpr std::uint8_t kNodes[] = {1};
    return read_watchdogs(*bench.session, profile, kNodes).front().value().stops;
  }

  bool refuses = true;
  MotionBench bench{"cia402"};
  drive::Profile profile = bench.profile();
};

TEST_F(UnreadReaction, LeavesOpenWhatTheMotorDoes) {
  set_behaviour(1);
  const auto found = plan();
  ASSERT_TRUE(found) << found.error().message.text();
  EXPECT_EQ(found->option, std::nullopt);
  EXPECT_FALSE(found->reaction_off) << "it is not written either";
  EXPECT_EQ(found->stops(), Stops::unknown);
  EXPECT_NE(to_string(*found).find("NOT KNOWN is what the motor then does: no 6007h tells it"),
            std::string::npos)
      << to_string(*found);
  EXPECT_NE(expectation(*found, true).find("whether the motor then stops is not known"), std::string::npos);
  EXPECT_EQ(reported(), Stops::unknown);
}

TEST_F(UnreadReaction, DoesNotMatterWhereTheDriveLosesItsPowerBefore) {
  set_behaviour(0);
  EXPECT_EQ(plan().value().stops(), Stops::yes);
  EXPECT_EQ(reported(), Stops::yes);
}

TEST_F(UnreadReaction, OfADriveThatIsSilentIsAnError) {
  refuses = false;
  bench.bus->swallows = [](const std::string& frame) { return frame.starts_with("601#40076000"); };
  const auto found = plan();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Errc::timeout);
}

TEST_F(UnreadReaction, IsToldByItsSignWhereItIsRead) {
  refuses = false;
  set_behaviour(1);
  ASSERT_TRUE(bench.session->download(1, objects::kAbortConnectionOption, store_le(0xFFFFU, 2)));
  constexpr std::uint8_t kNodes[] = {1};
  EXPECT_EQ(read_watchdogs(*bench.session, profile, kNodes).front().value().option, -1);
}

}  // namespace
}  // namespace servoctl::motion
