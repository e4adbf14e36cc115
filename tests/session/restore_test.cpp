// A restore ends with everything as wanted, or as it was, or names what is neither: also on a bus that loses
// and repeats frames, with a drive that refuses, restarts or falls silent at any step.
#include "session/restore.hpp"

#include <gtest/gtest.h>

#include "drive/quantity.hpp"
#include "troubled_bus.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

const std::filesystem::path kFolders[] = {std::filesystem::path(SERVOCTL_SOURCE_DIR) / "eds"};

class World {
 public:
  World() : drive_(profile(), 1, memory_, "1") {
    bus_.attach(drive_);
    present = read();
  }
  sim::SimDrive& drive() { return drive_; }
  static const drive::Profile& profile() {
    static const auto kProfile = drive::load_profile("gsd600", kFolders).value();
    return kProfile;
  }

  RestoreOutcome run(const Trouble& trouble, unsigned seed, RestoreOptions options = {}) {
    auto troubled = std::make_unique<TroubledBus>(bus_, drive(), trouble, seed);
    const auto* counted = troubled.get();
    Session session(std::move(troubled), "sim", {});
    session.options().cancelled = [&] {
      return trouble.cancel_at >= 0 && counted->frames() > trouble.cancel_at;
    };
    auto outcome = restore(session, &profile(), 1, present, wanted, options);
    frames = counted->frames();
    return outcome;
  }

  /// What the drive really holds, asked on a quiet bus.
  Values read() {
    drive().misbehaviour() = {};
    Session session(std::make_unique<TroubledBus>(bus_, drive(), Trouble{}, 1), "sim", {});
    (void)session.wait([] { return false; }, session.now() + 1s);
    Values out;
    for (const auto& value : wanted) {
      auto answer = session.upload(1, value.first);
      EXPECT_TRUE(answer) << to_string(value.first);
      if (answer) out.emplace(value.first, std::move(*answer));
    }
    return out;
  }

  /// Parameters, an object that a restart forgets, and two PDOs.
  Values wanted{{{0x2000, 0x05}, {1, 0}},
                {{0x2001, 0x03}, {0x2C, 0x01}},
                {{0x2001, 0x0F}, {0xC2, 0x01}},
                {{0x2001, 0x10}, {0xE8, 0x03}},
                {{0x605A, 0}, {1, 0}},
                {{0x6065, 0}, {0x00, 0x00, 0x01, 0x00}},
                {{0x1400, 1}, {0x01, 0x02, 0x00, 0x00}},
                {{0x1400, 2}, {1}},
                {{0x1600, 0}, {2}},
                {{0x1600, 1}, {0x10, 0x00, 0x40, 0x60}},
                {{0x1600, 2}, {0x20, 0x00, 0x7A, 0x60}},
                {{0x1801, 1}, {0x81, 0x02, 0x00, 0x40}},
                {{0x1801, 2}, {2}},
                {{0x1A01, 0}, {1}},
                {{0x1A01, 1}, {0x20, 0x00, 0x64, 0x60}},
                {{0x1A01, 2}, {0, 0, 0, 0}}};
  Values present;
  int frames = 0;

 private:
  sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  sim::Memory memory_;
  sim::SimDrive drive_;
};

/// The promise: never a value that is neither told nor right.
void expect_kept(World& world, const RestoreOutcome& outcome) {
  const auto now = world.read();
  if (!outcome.failure) {
    EXPECT_EQ(now, world.wanted);
    EXPECT_TRUE(outcome.astray.empty());
    return;
  }
  for (const auto& [object, data] : now) {
    const bool told = std::find(outcome.astray.begin(), outcome.astray.end(), object) != outcome.astray.end();
    if (!told) {
      EXPECT_EQ(data, world.present.at(object)) << to_string(object) << "; " << outcome.failure->message;
    }
  }
  EXPECT_EQ(outcome.rolled_back, outcome.astray.empty());
}

TEST(Restore, WritesWhatDiffersAndEndsWithWhatIsWanted) {
  World world;
  const auto outcome = world.run({}, 1);
  EXPECT_FALSE(outcome.failure) << outcome.failure->message;
  EXPECT_GT(outcome.writes, 10U);
  expect_kept(world, outcome);
}

TEST(Restore, OfWhatIsThereWritesNothing) {
  World world;
  world.wanted = world.present;
  const auto outcome = world.run({}, 1);
  EXPECT_EQ(outcome.writes, 0U);
  EXPECT_TRUE(plan_writes(&world.profile(), world.present, world.present).empty());
}

/// Runs a restore once for each of its frames, with trouble at that frame; `expect` says what has to come of
/// it beside the promise.
void with_trouble_at_every_step(int Trouble::*kind,
                                const std::function<void(const RestoreOutcome&)>& expect) {
  World measure;
  (void)measure.run({}, 1);
  for (int step = 0; step < measure.frames; ++step) {
    SCOPED_TRACE(step);
    World world;
    Trouble trouble;
    trouble.*kind = step;
    const auto outcome = world.run(trouble, 1);
    expect(outcome);
    expect_kept(world, outcome);
  }
}

TEST(Restore, PutsEverythingBackAfterARefusalAtAnyStep) {
  with_trouble_at_every_step(&Trouble::abort_at, [](const RestoreOutcome& outcome) {
    ASSERT_TRUE(outcome.failure);
    EXPECT_TRUE(outcome.rolled_back);
  });
}

TEST(Restore, PutsEverythingBackAfterCtrlCAtAnyStep) {
  with_trouble_at_every_step(&Trouble::cancel_at, [](const RestoreOutcome& outcome) {
    ASSERT_TRUE(outcome.failure);
    EXPECT_EQ(outcome.failure->code, Errc::interrupted);
    EXPECT_TRUE(outcome.rolled_back);
  });
}

TEST(Restore, NamesWhatIsUncertainWhenTheDriveFallsSilentAtAnyStep) {
  with_trouble_at_every_step(&Trouble::silent_at, [](const RestoreOutcome& outcome) {
    ASSERT_TRUE(outcome.failure);
    EXPECT_FALSE(outcome.astray.empty());
  });
}

TEST(Restore, NoticesADriveThatRestartsInBetween) {
  with_trouble_at_every_step(&Trouble::reset_at, [](const RestoreOutcome&) {});
}

TEST(Restore, KeepsItsPromiseInAThousandRunsOnABadBus) {
  std::size_t done = 0;
  std::size_t back = 0;
  std::size_t told = 0;
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto up_to = [&](int most) { return std::uniform_int_distribution(0, most)(random); };
    Trouble trouble;
    trouble.lose = up_to(8) / 100.;
    trouble.repeat = up_to(20) / 100.;
    if (up_to(3) == 0) trouble.reset_at = up_to(120);
    if (up_to(3) == 0) trouble.abort_at = up_to(120);
    if (up_to(5) == 0) trouble.silent_at = up_to(120);
    if (up_to(5) == 0) trouble.cancel_at = up_to(120);
    World world;
    const auto outcome = world.run(trouble, seed);
    ++(!outcome.failure ? done : outcome.rolled_back ? back : told);
    expect_kept(world, outcome);
    if (testing::Test::HasFailure()) break;
  }
  // Every way out is really taken.
  EXPECT_GT(done, 50U);
  EXPECT_GT(back, 50U);
  EXPECT_GT(told, 50U);
}

TEST(Restore, LeavesThingsAsTheyAreWhenToldSo) {
  World world;
  Trouble trouble;
  trouble.abort_at = 30;
  RestoreOptions options;
  options.roll_back = false;
  const auto outcome = world.run(trouble, 1, options);
  ASSERT_TRUE(outcome.failure);
  EXPECT_FALSE(outcome.rolled_back);
  EXPECT_NE(world.read(), world.present);
}

}  // namespace
}  // namespace servoctl::session
