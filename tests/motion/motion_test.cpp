// Motion of every family in virtual time: it ends where it should, and leaves the drive without power and
// with every object as it was.
#include "motion_support.hpp"

#include <cstdlib>
#include <ostream>

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

struct Family {
  const char* name;
  double turn;  ///< Increments in one turn, where the drive does not tell.
  const char* method;
  const char* torque;
};

void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }

constexpr Family kFamilies[] = {
    {"cia402", 10000, "1", "100%"}, {"gsd600", 131072, "1", "5%"}, {"da200", 10000, "1", "5%"},
    {"sv2", 0, "17", "5%"},         {"ts", 10000, "1", "5%"},      {"dm", 0, "", "0.1Nm"},
};

class MotionOfFamily : public testing::TestWithParam<Family> {
 protected:
  MotionOfFamily() : bench(GetParam().name, GetParam().turn) {}

  void expect_left_alone(const MotionReport& done) {
    EXPECT_TRUE(done.end.verified || !done.begun);
    EXPECT_EQ(done.end.notes, std::vector<std::string>{});
    EXPECT_EQ(bench.drive().power_state(), DriveState::switch_on_disabled);
    EXPECT_FALSE(bench.drive().is_moving());
    EXPECT_EQ(bench.changed(), std::vector<std::string>{});
  }
  /// Some start with a method that is none, and cannot go back to it.
  static void choose_a_method(MotionBench& bench) {
    const std::string method = GetParam().method;
    const auto target = drive::target_at(&bench.profile(), {0x6098, 0});
    if (target.entry == nullptr || method.empty()) return;
    const auto data = od::encode(target.entry->type, od::Value(std::int64_t{std::stoi(method) + 1}));
    ASSERT_TRUE(bench.session->download(1, {0x6098, 0}, *data));
  }
  static double greatest(const MotionReport& done, Signal signal) {
    double out = 0;
    for (const auto& sample : done.samples) out = std::max(out, std::abs(sample[signal].value_or(0)));
    return out;
  }
  static double last(const MotionReport& done, Signal signal) {
    return done.samples.back()[signal].value_or(-1);
  }

  MotionBench bench;
};

/// The end of a timed motion is by time: nothing is read before the drive is told to stop, and no answer is
/// waited for past that time.
TEST_P(MotionOfFamily, ATimedMotionEndsInTimeThoughReadsAreNotAnswered) {
  for (const auto silent_after : {1500ms, 1950ms, 3000ms}) {
    MotionBench own(GetParam().name, GetParam().turn);
    std::optional<TimePoint> told;
    std::optional<TimePoint> stopped;
    own.started = [&] {
      own.bus->swallows = [&](const std::string& frame) {
        if (frame.substr(0, 4) != "601#") return false;
        if (frame.substr(4, 2) == "40")
          return told && own.session->now() - *told >= (frame.substr(6, 4) == "FF60" ? 0ms : silent_after);
        if (frame.substr(6, 2) != "FF" || frame.substr(8, 2) != "60") return false;
        const bool zero = load_le(own.drive().value(objects::kTargetVelocity)) == 0;
        if (!told && frame.substr(12) != "00000000") told = own.session->now();
        if (told && !zero && frame.substr(12) == "00000000" && !stopped) stopped = own.session->now();
        return false;
      };
    };
    (void)own.jog(jog_for("60rpm", 2s));
    ASSERT_TRUE(told && stopped);
    EXPECT_LE(*stopped - *told, 2s + 50ms);
    EXPECT_FALSE(own.energised());
  }
}

TEST_P(MotionOfFamily, JogTurnsForATimeAndLeavesNothingBehind) {
  const auto done = bench.jog(jog_for("60rpm", 1s));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_NEAR(greatest(done, Signal::velocity), 60, 1);
  EXPECT_GT(last(done, Signal::position), 200);
  expect_left_alone(done);
}

TEST_P(MotionOfFamily, JogTurnsBackwardsSoManyTurns) {
  const auto done = bench.jog(jog_turns("-120rpm", 2));
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_NEAR(last(done, Signal::position), -720, 30);
  expect_left_alone(done);
}

TEST_P(MotionOfFamily, MoveArrivesAtItsTargetAndLeavesNothingBehind) {
  for (const char* target : {"180deg", "-90deg"}) {
    const auto done = bench.move(move_to(target, "60rpm"));
    ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
    EXPECT_NEAR(last(done, Signal::position), std::atof(target), 3);
    EXPECT_LT(greatest(done, Signal::velocity), 61);
    expect_left_alone(done);
  }
}

TEST_P(MotionOfFamily, RelativeMoveCountsFromWhereTheMotorStands) {
  for (int i = 1; i <= 2; ++i) {
    const auto done = bench.move(move_to("90deg", "60rpm", true));
    ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
    EXPECT_NEAR(last(done, Signal::position), 90 * i, 3);
  }
}

TEST_P(MotionOfFamily, HomingEndsHomedAndIsNotTakenFromAnEarlierRun) {
  bench.obey_switches();
  choose_a_method(bench);
  for (int i = 0; i < 2; ++i) {
    const auto done = bench.home(home_by(GetParam().method));
    if (!bench.profile().rules.motion.homing) {
      ASSERT_FALSE(done.outcome);
      EXPECT_EQ(done.outcome.error().code, Errc::refused);
      return;
    }
    ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
    // It has at least a turn to go: an answer that was there before would come at once.
    EXPECT_GE(done.samples.back().time - done.samples.front().time, 900ms);
    expect_left_alone(done);
    bench.drive().track().negative_limit.to -= 1;
  }
}

TEST_P(MotionOfFamily, TorquePushesForATimeAndNoFasterThanItsLimit) {
  bench.options.speed_limit = "100rpm";
  const auto done = bench.torque({.torque = GetParam().torque, .length = 500ms});
  ASSERT_TRUE(done.outcome) << done.outcome.error().message.text();
  EXPECT_GT(greatest(done, Signal::velocity), 0);
  EXPECT_LE(greatest(done, Signal::velocity), 120);
  expect_left_alone(done);
}

TEST_P(MotionOfFamily, ARunawayUnderTorqueIsStopped) {
  bench.options.speed_limit = "30rpm";
  const auto done = bench.torque({.torque = GetParam().torque, .length = 60s});
  if (done.outcome) {
    EXPECT_LE(greatest(done, Signal::velocity), 31);  // The drive itself held the limit.
  } else {
    EXPECT_EQ(done.outcome.error().code, Errc::negative);
    EXPECT_LE(greatest(done, Signal::velocity), 40);
  }
  expect_left_alone(done);
}

TEST_P(MotionOfFamily, SpeedAboveTheSafeOneIsRefusedBeforeAnythingIsWritten) {
  const auto done = bench.jog(jog_for("301rpm", 1s));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::refused);
  for (const auto& frame : bench.bus->frames) EXPECT_NE(frame.substr(0, 5), "601#2") << frame;
}

/// What an earlier master left in the targets must not move the motor when it is enabled.
TEST_P(MotionOfFamily, EnablingMovesNothingWhateverTheTargetsHeld) {
  MotionUnits units(*bench.session, bench.profile(), 1, bench.options.turn);
  for (const auto& [object, value] :
       {std::pair(objects::kTargetVelocity, 60.), std::pair(objects::kTargetPosition, 360.)}) {
    const auto data = units.bytes(object, value);
    ASSERT_TRUE(data);
    ASSERT_TRUE(bench.session->download(1, object, *data));
  }
  const auto& rules = bench.profile().rules.motion;
  for (const auto mode : {rules.velocity, rules.position, rules.torque}) {
    bench.before = bench.objects();
    Motion motion(*bench.session, bench.profile(), 1, bench.options);
    ASSERT_TRUE(motion.prepare());
    ASSERT_TRUE(motion.begin(*mode, {}));
    EXPECT_TRUE(bench.energised());
    EXPECT_TRUE(motion.watch([](const MotionSample&) -> Result<bool> { return false; }, 200ms));
    const auto done = motion.finish({});
    EXPECT_EQ(greatest(done, Signal::velocity), 0);
    EXPECT_EQ(greatest(done, Signal::position), 0);
    expect_left_alone(done);
  }
}

/// Ctrl-C at any moment, and never heard again while the drive is being stopped.
TEST_P(MotionOfFamily, CancelledAtAnyPointLeavesNothingBehind) {
  for (int point = 1; point < 400; point += 23) {
    MotionBench own(GetParam().name, GetParam().turn);
    int asked = 0;
    own.started = [&] { own.session->options().cancelled = [&] { return ++asked >= point; }; };
    const auto done = point % 2 == 0 ? own.jog(jog_for("60rpm", 1s)) : own.move(move_to("180deg", "60rpm"));
    if (!done.outcome) {
      EXPECT_EQ(done.outcome.error().code, Errc::interrupted);
    }
    EXPECT_TRUE(done.end.verified || !done.begun) << point;
    EXPECT_FALSE(own.energised()) << point;
    EXPECT_EQ(own.changed(), std::vector<std::string>{})
        << point << (done.end.left.empty() ? "" : ": " + done.end.left.front());
  }
}

TEST_P(MotionOfFamily, CancelledWhileHomingLeavesNothingBehind) {
  for (int point = 1; point < 300; point += 29) {
    MotionBench own(GetParam().name, GetParam().turn);
    if (!own.profile().rules.motion.homing) return;
    own.obey_switches();
    choose_a_method(own);
    int asked = 0;
    own.started = [&] { own.session->options().cancelled = [&] { return ++asked >= point; }; };
    const auto done = own.home(home_by(GetParam().method));
    EXPECT_TRUE(done.end.verified || !done.begun) << point;
    EXPECT_FALSE(own.energised()) << point;
    EXPECT_EQ(own.changed(), std::vector<std::string>{}) << point;
  }
}

TEST_P(MotionOfFamily, SilenceInMidMoveIsToldAndTheDriveStopsByItself) {
  bench.started = [&] { bench.drive().fall_silent_at(bench.session->now() + 600ms); };
  const auto done = bench.jog(jog_for("60rpm", 5s));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::timeout);
  EXPECT_FALSE(done.end.verified);
  // Its cable is out: what it does now it does by itself.
  if (done.watchdog.kind == WatchdogPlan::Kind::none) return;
  bench.wait(done.watchdog.time + 30ms);
  EXPECT_FALSE(bench.energised());
}

TEST_P(MotionOfFamily, ALostBusInMidMoveIsToldAndTheDriveStopsByItself) {
  bench.started = [&] { bench.bus->lost_after = bench.bus->sent + 250; };
  const auto done = bench.jog(jog_for("60rpm", 5s));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::bus);
  EXPECT_FALSE(done.end.verified);
  if (done.watchdog.kind == WatchdogPlan::Kind::none) return;
  bench.wait(done.watchdog.time + 30ms);
  EXPECT_FALSE(bench.energised());
}

TEST_P(MotionOfFamily, AFaultInMidMoveEndsItWithTheReason) {
  bench.started = [&] { bench.drive().raise_fault_at({0x2310, {}}, bench.session->now() + 600ms); };
  const auto done = bench.jog(jog_for("60rpm", 5s));
  ASSERT_FALSE(done.outcome);
  EXPECT_EQ(done.outcome.error().code, Errc::negative);
  EXPECT_NE(done.outcome.error().message.text().find("0x2310"), std::string::npos)
      << done.outcome.error().message.text();
  EXPECT_TRUE(done.end.verified || !done.begun);
  EXPECT_EQ(done.end.state, DriveState::fault);
  EXPECT_EQ(bench.changed(), std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Families, MotionOfFamily, testing::ValuesIn(kFamilies),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace servoctl::motion
