// A restore ends with everything as wanted, or as it was, or names what is neither: also on a bus that loses
// and repeats frames, with a drive that refuses, restarts or falls silent at any step.
#include "session/restore.hpp"

#include <gtest/gtest.h>

#include "drive/quantity.hpp"
#include "tests/source_dir.hpp"
#include "troubled_bus.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

/// Name or address of an object, and what it is to hold.
using Wish = std::pair<const char*, std::int64_t>;

/// Parameters, an object that a restart forgets, and PDOs.
const std::map<std::string, std::vector<Wish>> kWishes{
    {"gsd600",
     {{"2000h:5", 1},
      {"2001h:3", 300},
      {"2001h:F", 450},
      {"2001h:10", 1000},
      {"605Ah", 1},
      {"6065h", 0x10000},
      {"1400h:1", 0x201},
      {"1400h:2", 1},
      {"1600h:0", 2},
      {"1600h:1", 0x60400010},
      {"1600h:2", 0x607A0020},
      {"1801h:1", 0x40000281},
      {"1801h:2", 2},
      {"1A01h:0", 1},
      {"1A01h:1", 0x60640020},
      {"1A01h:2", 0}}},
    {"da200", {{"P5.12", 77}, {"6065h", 5000}, {"1800h:2", 1}, {"6083h", 3000}, {"6084h", 4000}}},
    {"dm",
     {{"1006h", 2000},
      {"1014h", 0x82},
      {"1016h:1", 0x0005'01F4},
      {"1017h", 500},
      {"1019h", 10},
      {"1800h:2", 1},
      {"1A00h:0", 1},
      {"1A00h:1", 0x60640020},
      {"1A00h:2", 0},
      {"1400h:2", 1}}},
    {"sv2", {{"2001h:1", 60}, {"2001h:2", 90}, {"6083h", 3000}, {"6084h", 4000}}},
    {"ts", {{"Fn_33", 120}, {"Fn_3A", 3}, {"Fn_12E", 50}, {"1017h", 500}, {"1800h:2", 1}}},
};

class World {
 public:
  explicit World(const std::string& family = "gsd600")
      : profile_(&profile(family)), drive_(*profile_, 1, memory_, "1") {
    bus_.attach(drive_);
    for (const auto& [name, value] : kWishes.at(family)) {
      const auto target = drive::resolve(profile_, name).value();
      wanted.emplace(target.address, od::encode(drive::meaning(target, 1).type, od::Value(value)).value());
    }
    present = read();
  }
  sim::SimDrive& drive() { return drive_; }
  static const drive::Profile& profile(const std::string& family = "gsd600") {
    static std::map<std::string, drive::Profile> profiles;
    const auto found = profiles.find(family);
    if (found != profiles.end()) return found->second;
    return profiles.emplace(family, drive::load_profile(family, kFolders).value()).first->second;
  }

  RestoreOutcome run(const Trouble& trouble, unsigned seed, RestoreOptions options = {}) {
    auto troubled = std::make_unique<TroubledBus>(bus_, drive(), trouble, seed);
    const auto* counted = troubled.get();
    Session session(std::move(troubled), "sim", {});
    session.options().cancelled = [&] {
      return trouble.cancel_at >= 0 && counted->frames() > trouble.cancel_at;
    };
    auto outcome = restore(session, profile_, 1, present, wanted, options);
    frames = counted->frames();
    return outcome;
  }

  /// What the drive really holds, asked on a quiet bus.
  Values read() {
    drive().wire_faults() = {};
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

  Values wanted;
  Values present;
  int frames = 0;

 private:
  const drive::Profile* profile_;
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
      EXPECT_EQ(data, world.present.at(object))
          << to_string(object) << "; " << outcome.failure->message.text();
    }
  }
  EXPECT_EQ(outcome.rolled_back, outcome.astray.empty());
}

TEST(Restore, WritesWhatDiffersAndEndsWithWhatIsWanted) {
  for (const auto& each : kWishes) {
    SCOPED_TRACE(each.first);
    World world(each.first);
    EXPECT_NE(world.present, world.wanted);
    const auto outcome = world.run({}, 1);
    EXPECT_FALSE(outcome.failure) << outcome.failure->message.text();
    EXPECT_GT(outcome.writes, 2U);
    expect_kept(world, outcome);
  }
}

TEST(Restore, OfWhatIsThereWritesNothing) {
  World world;
  world.wanted = world.present;
  const auto outcome = world.run({}, 1);
  EXPECT_EQ(outcome.writes, 0U);
  EXPECT_TRUE(plan_writes(&world.profile(), world.present, world.present).empty());
}

/// Runs a restore of every family once for each of its frames, with trouble at that frame; `expect` says what
/// has to come of it beside the promise.
void with_trouble_at_every_step(int Trouble::*kind,
                                const std::function<void(const RestoreOutcome&)>& expect) {
  for (const auto& each : kWishes) {
    SCOPED_TRACE(each.first);
    World measure(each.first);
    (void)measure.run({}, 1);
    for (int step = 0; step < measure.frames; ++step) {
      SCOPED_TRACE(step);
      World world(each.first);
      Trouble trouble;
      trouble.*kind = step;
      const auto outcome = world.run(trouble, 1);
      expect(outcome);
      expect_kept(world, outcome);
    }
  }
}

TEST(Restore, PutsEverythingBackAfterARefusalAtAnyStep) {
  with_trouble_at_every_step(&Trouble::abort_at, [](const RestoreOutcome& outcome) {
    ASSERT_TRUE(outcome.failure);
    EXPECT_TRUE(outcome.rolled_back);
    for (const auto& notice : outcome.notices)
      EXPECT_EQ(notice.text().find("what was written went to RAM"), std::string::npos) << notice.text();
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
    trouble.late = up_to(4) / 100.;
    if (up_to(3) == 0) trouble.reset_at = up_to(120);
    if (up_to(3) == 0) trouble.abort_at = up_to(120);
    if (up_to(5) == 0) trouble.silent_at = up_to(120);
    if (up_to(5) == 0) trouble.cancel_at = up_to(120);
    World world(std::next(kWishes.begin(), static_cast<std::ptrdiff_t>(seed % kWishes.size()))->first);
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
