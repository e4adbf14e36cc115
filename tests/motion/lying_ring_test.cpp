// Slaves that lie about their process data, their mailbox or their state from some moment of a motion on: the
// stop words are in the outputs at once, and the end never claims what was not seen. LYING_SLAVES=COUNT and
// LYING_SEED=SEED make it an attack (tests/attack).
#include <fmt/format.h>
#include <cstdlib>
#include <random>

#include "ethercat_motion.hpp"
#include "motion/power.hpp"
#include "sim/esc_lies.hpp"

namespace servoctl::motion {
namespace {

using namespace std::chrono_literals;
using drive::DriveState;

/// What a drive was told after it began to lie, by the outputs that it took.
class LyingRing : public EtherCatMotion {
 protected:
  void lie(const std::string& options) {
    open("sv2@1?" + options);
    network().learn(1, rules());
    lied_at_.reset();
    stopped_at_.reset();
    without_power_at_.reset();
    on_sent_ = [this] { look(); };
  }
  bool lies() {
    const auto& faults = slave().faults();
    const auto& wrong = slave().model().misbehaviour();
    return faults.withholds_inputs || faults.senseless_counter || faults.silent_mailbox ||
           faults.frozen_inputs || faults.frozen_outputs || faults.frozen_state || wrong.statusword ||
           wrong.mode;
  }
  /// A stop word: target zero where that moves the motor, or a controlword that no longer enables.
  bool is_told_to_stop() {
    const auto& values = slave().model().values();
    const auto word = values.number(objects::kControlword);
    const auto mode = values.number(objects::kModeOfOperation);
    const bool zero = (mode == 3 && values.number(objects::kTargetVelocity) == 0) ||
                      (mode == 4 && values.number(objects::kTargetTorque) == 0);
    return zero || (word & 0x010FU) != 0x000FU;
  }
  void look() {
    const auto now = port_->now();
    if (!lied_at_ && lies()) lied_at_ = now;
    if (!lied_at_) return;
    if (!stopped_at_ && is_told_to_stop()) stopped_at_ = now;
    if (!without_power_at_ && !drive::is_energised(slave().model().power_state())) without_power_at_ = now;
  }
  Duration until_stop() const { return stopped_at_ && lied_at_ ? *stopped_at_ - *lied_at_ : Duration(1h); }
  Duration until_power_gone() const {
    return without_power_at_ && lied_at_ ? *without_power_at_ - *lied_at_ : Duration(1h);
  }
  Torque torque() const {
    Torque out;
    out.torque = "5%";
    out.length = 5s;
    return out;
  }
  /// Motions that would go on for some seconds.
  std::vector<std::function<MotionReport()>> motions() {
    return {[this] { return jog("60rpm", 5s); },
            [this] { return run(move_to("5rev", "60rpm", true), plan_move, run_move); },
            [this] { return run(torque(), plan_torque, run_torque); }};
  }

  std::optional<TimePoint> lied_at_;
  std::optional<TimePoint> stopped_at_;
  std::optional<TimePoint> without_power_at_;
};

TEST_F(LyingRing, StopWordsAreInTheOutputsAtOnceWhateverTheWorkingCounterIs) {
  for (const auto* word : {"wkc", "wkc-max"})
    for (std::size_t i = 0; i < motions().size(); ++i) {
      SCOPED_TRACE(fmt::format("{}, motion {}", word, i));
      lie(fmt::format("lie={}&lie-after=900ms", word));
      const auto done = motions()[i]();
      ASSERT_FALSE(done.outcome);
      EXPECT_NE(done.outcome.error().message.text().find("working counter"), std::string::npos)
          << done.outcome.error().message.text();
      EXPECT_LT(until_stop(), 80ms);
      EXPECT_LT(until_power_gone(), 500ms);
      expect_safe();
    }
}

TEST_F(LyingRing, CtrlCIsObeyedAtOnceByADriveThatReturnsNoInputs) {
  for (std::size_t i = 0; i < motions().size(); ++i) {
    lie("lie=wkc&lie-after=900ms");
    session_->options().cancelled = [this] { return lies(); };
    const auto done = motions()[i]();
    ASSERT_FALSE(done.outcome);
    EXPECT_LT(until_stop(), 80ms) << i;
    EXPECT_LT(until_power_gone(), 500ms) << i;
    expect_safe();
  }
}

/// As a held `enable` is ended; 605Ah = 6 keeps the drive in quick stop active.
TEST_F(LyingRing, AHeldDriveThatReturnsNoInputsIsLetGo) {
  for (const auto* word : {"wkc", "wkc-max"}) {
    lie(fmt::format("lie={}&lie-after=1s", word));
    ASSERT_TRUE(session_->download(1, objects::kQuickStopOption, store_le(6U, 2)));
    Motion motion(*session_, profile(), 1, {});
    ASSERT_TRUE(motion.prepare());
    MotionGuard guard(*session_, motion.units(), 1);
    ASSERT_TRUE(guard.start_node());
    ASSERT_TRUE(guard.neutral_targets());
    ASSERT_TRUE(guard.enable());
    ASSERT_TRUE(guard.release());
    pass(2s);
    ASSERT_TRUE(lies());
    std::vector<std::uint64_t> words;
    on_sent_ = [&] {
      const auto held = slave().model().values().number(objects::kControlword);
      if (words.empty() || words.back() != held) words.push_back(held);
    };
    const auto begun = session_->now();
    (void)de_energise(*session_);
    EXPECT_LT(session_->now() - begun, 3s) << word;
    expect_safe();
    EXPECT_EQ(words, (std::vector<std::uint64_t>{0x02, 0x07, 0x00})) << word;
  }
}

TEST_F(LyingRing, ATimedJogEndsInTimeThoughItsMailboxIsSilent) {
  for (const auto after : {1500ms, 1900ms, 1990ms, 2100ms}) {
    lie(fmt::format("lie=silent-mailbox&lie-after={}ms", after.count()));
    std::optional<TimePoint> told;
    std::optional<TimePoint> stopped;
    on_sent_ = [&] {
      const auto speed = slave().model().values().number(objects::kTargetVelocity);
      if (!told && speed != 0) told = port_->now();
      if (told && !stopped && is_told_to_stop()) stopped = port_->now();
    };
    (void)jog("60rpm", 2s);
    ASSERT_TRUE(told && stopped);
    EXPECT_LE(*stopped - *told, 2s + 20ms) << after.count();
    expect_safe();
  }
}

/// Each further signal makes an exit path faster, and none ends it.
TEST_F(LyingRing, ASecondSignalMakesAGentleStopAQuickOne) {
  for (const bool again : {false, true}) {
    lie("lie=mode&lie-after=3600s");
    unsigned signals = 0;
    std::vector<std::string> told;
    session_->options().signals = [&] { return signals; };
    session_->options().tell = [&](std::string_view line) { told.emplace_back(line); };
    bool pressed = false;
    session_->options().cancelled = [&] { return pressed; };
    options_.on_sample = [&, begin = std::optional<TimePoint>()](const MotionSample& sample) mutable {
      if (!begin) begin = sample.time;
      pressed = sample.time - *begin > 1s;
      if (pressed) signals = 1;
    };
    on_sent_ = [&] {
      if (again && pressed && is_told_to_stop()) signals = 2;
    };
    const auto done = jog("250rpm", 5s);
    EXPECT_EQ(done.end.quick_stop, again);
    EXPECT_TRUE(done.end.verified);
    EXPECT_EQ(told.empty(), !again);
    expect_safe();
  }
}

int number_from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : otherwise;
}

TEST_F(LyingRing, NeverLeavesADriveEnergisedOrClaimsWhatWasNotSeen) {
  const int count = number_from_environment("LYING_SLAVES", 60);
  const auto seed = static_cast<unsigned>(number_from_environment("LYING_SEED", 1));
  for (int i = 0; i < count; ++i) {
    std::mt19937 random(seed * 100'003U + static_cast<unsigned>(i));
    const auto pick = [&](std::size_t most) { return static_cast<std::size_t>(random() % most); };
    std::string words;
    for (std::size_t lies = 1 + pick(2); lies > 0; --lies)
      words +=
          std::string(words.empty() ? "" : ",") + std::string(sim::kRingLies[pick(sim::kRingLies.size())]);
    const auto options = fmt::format("lie={}&lie-after={}ms", words, pick(2500));
    const auto motion = pick(3);
    const auto what =
        fmt::format("LYING_SLAVES={} LYING_SEED={}: {}, motion {}", i + 1, seed, options, motion);
    lie(options);
    const auto begun = session_->now();
    const auto done = motions()[motion]();
    const bool well = done.outcome && done.end.verified && done.end.left.empty();
    const bool has_power = drive::is_energised(slave().model().power_state());
    EXPECT_FALSE(well && has_power) << what << ": done, and it is energised";
    EXPECT_LT(session_->now() - begun, 60s) << what;
    on_sent_ = {};
    session_.reset();
    for (const auto end = port_->now() + 300ms; port_->now() < end;)
      if (!port_->receive(end)) break;
    EXPECT_FALSE(drive::is_energised(slave().model().power_state())) << what << ": energised at the end";
  }
}

}  // namespace
}  // namespace servoctl::motion
