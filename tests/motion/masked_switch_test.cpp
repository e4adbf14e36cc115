// Switches that a drive is told to ignore: homing to them is refused, with the parameter to change.
#include <gtest/gtest.h>

#include "motion_support.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;

/// Whether the plan for this method is made; else why not.
Result<void> planned(MotionBench& bench, const std::string& method) {
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  if (const auto ready = motion.prepare(); !ready) return ready;
  const auto plan = plan_home(motion, home_by(method));
  return plan ? Result<void>() : fail(plan.error());
}

void expect_refused(MotionBench& bench, const std::string& method, std::string_view why,
                    std::string_view remedy) {
  const auto done = planned(bench, method);
  ASSERT_FALSE(done) << method;
  EXPECT_EQ(done.error().code, Errc::refused) << method;
  EXPECT_NE(done.error().message.text().find(why), std::string::npos)
      << method << ": " << done.error().message.text();
  EXPECT_NE(done.error().hint.text().find(remedy), std::string::npos)
      << method << ": " << done.error().hint.text();
}

void set_mask(MotionBench& bench, unsigned value) {
  ASSERT_TRUE(bench.session->download(1, {0x2003, 4}, store_le(value, 2)));
}

TEST(MaskedSwitch, HomingToALimitInputThatIsForcedOnIsRefusedAsDelivered) {
  MotionBench bench("gsd600", 131072);
  for (const auto* method : {"1", "17", "27", "11"})
    expect_refused(bench, method, "needs the negative limit switch, which the drive ignores: Pn0603 = 3",
                   "`param set Pn0603=0 -n 1 --keep` and restart the drive");
  for (const auto* method : {"2", "7", "18", "23"})
    expect_refused(bench, method, "needs the positive limit switch, which the drive ignores: Pn0603 = 3",
                   "Pn0603=0");
  for (const auto* method : {"3", "6", "19", "33", "35"}) EXPECT_TRUE(planned(bench, method)) << method;
}

TEST(MaskedSwitch, OneForcedLimitInputRefusesItsOwnMethodsAlone) {
  MotionBench bench("gsd600", 131072);
  set_mask(bench, 1);
  for (const auto* method : {"1", "17", "27"}) EXPECT_TRUE(planned(bench, method)) << method;
  for (const auto* method : {"2", "18", "7", "23"})
    expect_refused(bench, method, "positive limit", "Pn0603=0");
  set_mask(bench, 2);
  for (const auto* method : {"2", "18", "7", "23"}) EXPECT_TRUE(planned(bench, method)) << method;
  for (const auto* method : {"1", "17", "27"}) expect_refused(bench, method, "negative limit", "Pn0603=0");
  set_mask(bench, 0);
  for (const auto* method : {"1", "2", "7", "17", "18", "23", "27"})
    EXPECT_TRUE(planned(bench, method)) << method;
}

/// Sets the function of a terminal: Pn0610 is that of DI0 in position mode, at 2003h:0Bh.
void assign(MotionBench& bench, std::uint8_t sub, unsigned function) {
  ASSERT_TRUE(bench.session->download(1, {0x2003, sub}, store_le(function, 2)));
}

TEST(MaskedSwitch, HomingToASwitchThatNoInputHasIsRefused) {
  MotionBench bench("gsd600", 131072);
  set_mask(bench, 0);
  for (const auto* method : {"3", "17", "18", "19"}) EXPECT_TRUE(planned(bench, method)) << method;
  assign(bench, 0x0F, 5);
  for (const auto* method : {"3", "19", "7", "23"})
    expect_refused(bench, method,
                   "needs the home switch, which the drive ignores: none of Pn0614, Pn0610, Pn0611, Pn0612, "
                   "Pn0613 is 41",
                   "`param set Pn0614=41 -n 1 --keep` and restart the drive; any of these inputs will do");
  for (const auto* method : {"17", "18"}) EXPECT_TRUE(planned(bench, method)) << method;
  assign(bench, 0x0B, 41);
  for (const auto* method : {"3", "19"})
    EXPECT_TRUE(planned(bench, method)) << method << ": another input has it";
  assign(bench, 0x0D, 0);
  expect_refused(bench, "18", "positive limit switch, which the drive ignores: none of Pn0612, ", "Pn0612=3");
  EXPECT_TRUE(planned(bench, "17"));
  assign(bench, 0x0E, 3);
  EXPECT_TRUE(planned(bench, "18")) << "another input has it";
  expect_refused(bench, "17", "negative limit switch, which the drive ignores: none of Pn0613, ", "Pn0613=4");
  assign(bench, 0x23, 4);
  EXPECT_TRUE(planned(bench, "17")) << "which set of functions counts is not stated";
}

TEST(MaskedSwitch, APanelParameterThatNobodyHasReadMayMaskIt) {
  MotionBench bench("sv2");
  for (const auto* method : {"17", "18", "23", "27"})
    expect_refused(bench, method, "PA-20 cannot be read; assumed: PA-20 = 1",
                   "set PA-20 = 0 on the panel and restart the drive, then add --panel PA-20=0");
  EXPECT_TRUE(planned(bench, "35"));
  bench.options.panel["PA20"] = 0;
  expect_refused(bench, "17", "PA-74 = 0", "--panel PA-74=1");
  bench.options.panel["PA-74"] = 1;
  EXPECT_TRUE(planned(bench, "17"));
  bench.options.panel["PA-20"] = 1;
  bench.options.panel.erase("PA20");
  expect_refused(bench, "17", "which the drive ignores: PA-20 = 1", "--panel PA-20=0");
}

TEST(MaskedSwitch, WhatCanBeReadIsNotToldByThePanelOption) {
  MotionBench bench("gsd600", 131072);
  bench.options.panel["Pn0603"] = 0;
  const auto done = planned(bench, "17");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::usage) << done.error().message.text();
}

TEST(MaskedSwitch, HomingToItWorksOnceTheDriveIsToldToObeyIt) {
  for (const auto* family : {"gsd600", "sv2"}) {
    MotionBench bench(family, 131072);
    bench.obey_switches();
    const auto done = bench.home(home_by("17"));
    EXPECT_TRUE(done.outcome) << family << ": " << done.outcome.error().message.text();
  }
}

/// The texts of what is shown for one motion.
std::string told_for(MotionBench& bench, const Purpose& purpose) {
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  EXPECT_TRUE(motion.prepare());
  (void)motion.intend(purpose);
  std::string out;
  const auto items = motion.look_at_drive(false);
  EXPECT_TRUE(items);
  for (const auto& item : items ? *items : std::vector<PreflightItem>())
    if (item.weight == PreflightItem::Weight::caution) out += item.text + "\n";
  return out;
}

bool tells(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

TEST(Cautions, BelongToTheMotionThatTheyConcern) {
  MotionBench da200("da200");
  EXPECT_TRUE(tells(told_for(da200, {drive::Use::home, 17}), "must be wired to CN1"));
  EXPECT_FALSE(tells(told_for(da200, {drive::Use::home, 35}), "must be wired to CN1"));
  EXPECT_FALSE(tells(told_for(da200, {drive::Use::jog}), "must be wired to CN1"));
  MotionBench ts("ts");
  EXPECT_TRUE(tells(told_for(ts, {drive::Use::enable}), "Fn_99"));
  EXPECT_FALSE(tells(told_for(ts, {drive::Use::jog}), "Fn_99"));
  MotionBench gsd600("gsd600", 131072);
  for (const auto use : {drive::Use::jog, drive::Use::move, drive::Use::torque})
    EXPECT_TRUE(
        tells(told_for(gsd600, {use}), "Pn0603 = 3 (factory value): the drive ignores both limit switches"));
  EXPECT_FALSE(tells(told_for(gsd600, {drive::Use::enable}), "Pn0603"));
}

TEST(Cautions, CapSpeedAndTorqueWhereTheDriveItselfDoesNot) {
  MotionBench bench("dm");
  Motion motion(*bench.session, bench.profile(), 1, bench.options);
  ASSERT_TRUE(motion.prepare());
  EXPECT_NEAR(motion.speed_cap().value(), 120, 0.1);
  EXPECT_NEAR(motion.torque_cap().value(), 3, 0.01);
}

}  // namespace
}  // namespace servoctl::motion
