// A number is converted by a unit that somebody states: the family's data, the drive, or the user.
#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

constexpr ObjectAddress kSiUnitVelocity{0x60A9, 0};

class ProvenUnits : public testing::Test {
 protected:
  void set(ObjectAddress object, std::uint32_t value) {
    ASSERT_TRUE(bench.session->download(1, object, store_le(value, 4)));
  }
  Result<std::uint64_t> speed_word(const std::string& speed) {
    Motion motion(*bench.session, bench.profile(), 1, bench.options);
    if (const auto ready = motion.prepare(); !ready) return fail(ready.error());
    const auto plan = plan_jog(motion, jog_for(speed, 1s));
    if (!plan) return fail(plan.error());
    return load_le(plan->command);
  }

  MotionBench bench{"cia402", 16384};
};

TEST_F(ProvenUnits, ADriveThatCountsRpmIsToldRpm) {
  set(kSiUnitVelocity, 0x00B44700);
  EXPECT_EQ(speed_word("60rpm").value(), 60U);
  set(kSiUnitVelocity, 0xFFB44700);  // Tenths of them.
  EXPECT_EQ(speed_word("60rpm").value(), 600U);
  set(kSiUnitVelocity, 0x00B50300);  // Increments a second.
  EXPECT_EQ(speed_word("60rpm").value(), 16384U);
}

TEST_F(ProvenUnits, AUnitThatNothingStatesConvertsNothing) {
  bench.drive().misbehaviour().missing = {0x60A9};
  const auto refused = bench.jog(jog_for("60rpm", 1s));
  ASSERT_FALSE(refused.outcome);
  EXPECT_FALSE(refused.begun);
  EXPECT_NE(refused.outcome.error().message.text().find("the unit of 0x60FF:0 is not known"),
            std::string::npos)
      << refused.outcome.error().message.text();
  EXPECT_FALSE(speed_word("1000inc/s")) << "nor is the recommended unit taken for granted";
  bench.options.speed_limit = "100";
  EXPECT_EQ(speed_word("60").value(), 60U) << "plain numbers stay possible";
}

TEST_F(ProvenUnits, AUnitThatNothingStatesIsToldBeforeTheQuestion) {
  bench.drive().misbehaviour().missing = {0x60A9};
  bench.options.speed_limit = "100";
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  const auto items = motion.look(false);
  ASSERT_TRUE(items);
  EXPECT_TRUE(std::any_of(items->begin(), items->end(), [](const PreflightItem& item) {
    return item.what == "units" && item.weight == PreflightItem::Weight::caution;
  }));
}

TEST_F(ProvenUnits, ACodeThatContradictsTheVelocityFactorProvesNothing) {
  set({0x6096, 1}, 60);
  set({0x6096, 2}, 16384);
  EXPECT_FALSE(speed_word("60rpm"));
  bench.drive().misbehaviour().missing = {0x60A9};
  EXPECT_EQ(speed_word("60rpm").value(), 60U) << "alone it says that the drive counts rpm";
}

TEST_F(ProvenUnits, ALostAnswerIsNoMissingObject) {
  for (const auto* object : {"601#4091600100000000", "601#4092600100000000", "601#40A9600000000000"}) {
    bench.bus->swallows = [object](const std::string& frame) { return frame == object; };
    const auto done = bench.jog(jog_for("60rpm", 1s));
    ASSERT_FALSE(done.outcome) << object;
    EXPECT_EQ(done.outcome.error().code, Errc::timeout) << object;
    EXPECT_FALSE(done.begun) << object;
  }
}

TEST_F(ProvenUnits, ACountOfOneInATurnIsAGearThatNobodySet) {
  MotionBench own("cia402");
  Motion motion(*own.session, own.profile(), 1, own.options);
  ASSERT_TRUE(motion.prepare());
  EXPECT_FALSE(motion.units().turn());
  ASSERT_TRUE(own.session->download(1, {0x608F, 1}, store_le(4096, 4)));
  Motion known(*own.session, own.profile(), 1, own.options);
  ASSERT_TRUE(known.prepare());
  EXPECT_EQ(known.units().turn(), 4096);
}

}  // namespace
}  // namespace servoctl::motion
