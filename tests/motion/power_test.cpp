#include "motion/power.hpp"

#include "motion/operation_mode.hpp"
#include "motion_support.hpp"
#include "tests/session/scripted_bus.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

class PowerOfFamily : public testing::TestWithParam<const char*> {};

TEST_P(PowerOfFamily, ReachesEveryStateFromEveryOther) {
  constexpr DriveState kStates[] = {DriveState::switch_on_disabled, DriveState::ready_to_switch_on,
                                    DriveState::switched_on, DriveState::operation_enabled};
  for (const auto from : kStates) {
    for (const auto to : kStates) {
      MotionBench bench(GetParam());
      Power power(*bench.session, bench.profile(), 1);
      ASSERT_TRUE(power.reach(from)) << drive::name(from);
      const auto reached = power.reach(to);
      ASSERT_TRUE(reached) << reached.error().message.text();
      EXPECT_EQ(bench.drive().power_state(), to) << drive::name(from) << " -> " << drive::name(to);
    }
  }
}

TEST_P(PowerOfFamily, DoesNotLeaveAFaultByItself) {
  MotionBench bench(GetParam());
  bench.drive().raise_fault(0x2310, {}, bench.session->now());
  bench.wait(50ms);
  bench.bus->frames.clear();
  Power power(*bench.session, bench.profile(), 1);
  for (const auto goal : {DriveState::operation_enabled, DriveState::switch_on_disabled}) {
    const auto reached = power.reach(goal);
    ASSERT_FALSE(reached);
    EXPECT_EQ(reached.error().code, Errc::refused);
  }
  for (const auto& frame : bench.bus->frames) EXPECT_EQ(frame.substr(0, 6), "601#40") << frame;
}

TEST_P(PowerOfFamily, LeavesAQuickStopDownwards) {
  MotionBench bench(GetParam());
  Power power(*bench.session, bench.profile(), 1);
  ASSERT_TRUE(power.reach(DriveState::operation_enabled));
  ASSERT_TRUE(power.command(0x0002));
  ASSERT_TRUE(power.reach(DriveState::switch_on_disabled));
  EXPECT_EQ(bench.drive().power_state(), DriveState::switch_on_disabled);
}

/// What is known behind it of the power that it had before.
std::optional<bool> had_power(MotionBench& bench, PowerAim aim) {
  std::vector<PowerDownPlan> plans(1);
  plans.front().node = 1;
  plans.front().aim = aim;
  const auto done = std::move(take_down(*bench.session, std::move(plans)).front());
  EXPECT_TRUE(done.outcome) << done.outcome.error().message.text();
  return done.had_power();
}

TEST_P(PowerOfFamily, TellsWhetherADriveHadAnyThatIsDisabled) {
  MotionBench bench(GetParam());
  Power power(*bench.session, bench.profile(), 1);
  EXPECT_EQ(had_power(bench, PowerAim::disable), false) << "it stood there without";
  ASSERT_TRUE(power.reach(DriveState::operation_enabled));
  EXPECT_NE(had_power(bench, PowerAim::disable), false);
  EXPECT_EQ(had_power(bench, PowerAim::disable), false);
  bench.drive().raise_fault(0x2310, {}, bench.session->now());
  bench.wait(50ms);
  EXPECT_EQ(had_power(bench, PowerAim::disable), false);
}

/// A motor at rest may have lost its power by 02h before anybody looks.
TEST_P(PowerOfFamily, ClaimsNothingOfTheTimeBeforeAQuickStop) {
  MotionBench bench(GetParam());
  Power power(*bench.session, bench.profile(), 1);
  EXPECT_EQ(had_power(bench, PowerAim::stop), std::nullopt);
  ASSERT_TRUE(power.reach(DriveState::operation_enabled));
  EXPECT_NE(had_power(bench, PowerAim::stop), false);
}

TEST(PowerDownResult, ClaimsNothingOfAStateThatNobodyKnows) {
  PowerDownResult done;
  EXPECT_EQ(done.had_power(), std::nullopt) << "it was never read";
  done.found = DriveState::unknown;
  EXPECT_EQ(done.had_power(), std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(Families, PowerOfFamily,
                         testing::Values("cia402", "gsd600", "da200", "sv2", "ts", "dm"),
                         [](const auto& one) { return std::string(one.param); });

/// A drive that acknowledges every controlword and shows one statusword for ever.
class Stubborn : public testing::Test {
 protected:
  Result<void> enable(const std::string& statusword) {
    return command(statusword, [](Power& power) { return power.reach(DriveState::operation_enabled); });
  }
  Result<void> quick_stop(const std::string& statusword) {
    return command(statusword, [](Power& power) { return power.quick_stop(); });
  }
  Result<void> disable(const std::string& statusword) {
    return command(statusword, [](Power& power) { return power.disable(); });
  }

 private:
  static Result<void> command(const std::string& statusword, const std::function<Result<void>(Power&)>& how) {
    auto owned = std::make_unique<session::ScriptedBus>();
    owned->on_send = [statusword](session::ScriptedBus& bus, const std::string& sent) {
      if (sent.substr(0, 12) == "601#40416000") bus.arrive("581#4B416000" + statusword + "0000");
      if (sent.substr(0, 12) == "601#406C6000") bus.arrive("581#436C6000E8030000");
      if (sent.substr(0, 12) == "601#2B406000") bus.arrive("581#6040600000000000");
    };
    session::Session session(std::move(owned), "test", session::Options{});
    MotionBench family("gsd600");
    Power power(session, family.profile(), 1);
    return how(power);
  }
};

TEST_F(Stubborn, ADriveThatObeysItsPanelIsToldAsSuch) {
  const auto done = enable("7000");  // 0x0070: voltage, but not remote.
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::negative);
  EXPECT_NE(done.error().hint.text().find("remote"), std::string::npos) << done.error().hint.text();
}

TEST_F(Stubborn, ADriveWithoutSupplyIsToldAsSuch) {
  const auto done = enable("4002");  // 0x0240: remote, but no voltage.
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().hint.text().find("voltage"), std::string::npos) << done.error().hint.text();
}

TEST_F(Stubborn, AStatuswordThatFitsNoStateIsNotCommandedOn) {
  const auto done = enable("0500");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::refused);
}

/// 605Ah (CiA 402-2): 2 leaves the quick stop downwards by itself, 5 stays in it with power.
TEST(QuickStop, IsLeftUpwardsOnlyWhereItsOptionKeepsThePower) {
  for (const auto& [option, first] : {std::pair("02", "0000"), std::pair("05", "0F00")}) {
    auto owned = std::make_unique<session::ScriptedBus>();
    std::vector<std::string> words;
    owned->on_send = [&, option = option](session::ScriptedBus& bus, const std::string& sent) {
      if (sent.substr(0, 12) == "601#40416000") bus.arrive("581#4B41600007060000");
      if (sent.substr(0, 12) == "601#405A6000") bus.arrive(std::string("581#4B5A6000") + option + "000000");
      if (sent.substr(0, 12) != "601#2B406000") return;
      words.push_back(sent.substr(12, 4));
      bus.arrive("581#6040600000000000");
    };
    session::Session session(std::move(owned), "test", session::Options{});
    MotionBench family("gsd600");
    EXPECT_FALSE(Power(session, family.profile(), 1).reach(DriveState::operation_enabled));
    ASSERT_FALSE(words.empty());
    EXPECT_EQ(words.front(), first) << option;
  }
}

TEST_F(Stubborn, AQuickStopThatChangesNothingIsNoSuccess) {
  const auto done = quick_stop("3706");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::negative);
  EXPECT_NE(done.error().message.text().find("does not follow the quick stop"), std::string::npos);
}

TEST_F(Stubborn, AFaultReactionThatDoesNotEndIsNotDisabled) {
  const auto done = disable("0F02");
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.text().find("is still braking"), std::string::npos)
      << done.error().message.text();
}

TEST(OperationMode, IsRefusedWhenTheDriveItselfDoesNotHaveIt) {
  MotionBench bench("gsd600");
  EXPECT_TRUE(check_mode(*bench.session, bench.profile(), 1, 3));
  const auto unknown = check_mode(*bench.session, bench.profile(), 1, 8);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, Errc::refused);
  MotionBench plain("cia402");
  EXPECT_TRUE(check_mode(*plain.session, plain.profile(), 1, 8));
}

}  // namespace
}  // namespace servoctl::motion
