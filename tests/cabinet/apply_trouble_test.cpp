// Whatever happens to an apply, each axis is as the file says, or as it was, or named; and what was cut off
// is gone on with.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

#include "fleet.hpp"
#include "settings/restore_journal.hpp"

namespace servoctl::cabinet {
namespace {

/// What the axes are to have: parameters, or PDOs and a heartbeat too.
enum class Extent : std::uint8_t { parameters, all };
constexpr std::array kExtents{Extent::parameters, Extent::all};

/// The cabinet of a seed: what its drives hold and are to hold.
class TroubledFleet {
 public:
  TroubledFleet(std::size_t axes, std::size_t buses, Extent extent) : fleet(axes, buses) {
    if (extent == Extent::all) fleet.give_pdos_and_heartbeats();
    for (const auto& look : fleet.look()) {
      EXPECT_TRUE(look.plan);
      session::Values values;
      for (const auto& entry : look.plan->wanted.entries) values.emplace(entry.object, *entry.bytes);
      wanted.push_back(std::move(values));
    }
    for (std::size_t i = 0; i < fleet.size(); ++i) before.push_back(fleet.held(i, wanted[i]));
  }
  bool is_as_wanted(std::size_t axis) { return fleet.held(axis, wanted[axis]) == wanted[axis]; }
  bool is_as_before(std::size_t axis) { return fleet.held(axis, wanted[axis]) == before[axis]; }
  bool is_named(std::size_t axis) const {
    return std::any_of(fleet.desk.errors.begin(), fleet.desk.errors.end(), [&](const Error& error) {
      return error.message.text().find(fleet.cabinet.axes[axis].name) != std::string::npos;
    });
  }
  bool is_cut_off(std::size_t axis) const {
    return fs::exists(settings::journal_of(before_file(fleet.cabinet, fleet.cabinet.axes[axis])));
  }
  bool any_cut_off() const {
    for (std::size_t i = 0; i < fleet.size(); ++i)
      if (is_cut_off(i)) return true;
    return false;
  }
  /// All is well again: what was cut off is gone on with, the rest applied.
  void finish() {
    fleet.heal();
    ApplyOptions resume;
    resume.resume = true;
    if (any_cut_off()) {
      const auto resumed = fleet.apply(resume);
      ASSERT_TRUE(resumed) << resumed.error().message.text();
      for (const auto& error : fleet.desk.errors) ADD_FAILURE() << error.message.text();
    }
    EXPECT_FALSE(any_cut_off());
    ASSERT_TRUE(fleet.apply());
    for (const auto& error : fleet.desk.errors) ADD_FAILURE() << error.message.text();
    EXPECT_EQ(fleet.different(), 0U);
  }

  Fleet fleet;
  std::vector<session::Values> wanted;
  std::vector<session::Values> before;
};

BusTrouble trouble_of(unsigned seed, int requests) {
  std::mt19937 random(seed);
  const auto some = [&] { return static_cast<int>(random() % static_cast<unsigned>(requests)); };
  BusTrouble out;
  out.seed = seed;
  switch (seed % 7) {
    case 0: out.lose = 0.01 + 0.05 * static_cast<double>(random() % 4); break;
    case 1: out.abort_at = some(); break;
    case 2: out.reset_at = some(); break;
    case 3: out.silent_at = some(); break;
    case 4: out.cancel_at = some(); break;
    case 5: out.lost_at = some(); break;
    default:
      out.lose = 0.01;
      out.reset_at = some();
      out.abort_at = some();
  }
  return out;
}

/// Every other turn of the troubles has the PDOs in it.
std::size_t extent_of(int seed) { return static_cast<std::size_t>(seed) / 7 % 2; }

int seeds(int standard) {
  const auto* wanted = std::getenv("SERVOCTL_SEEDS");
  return wanted == nullptr ? standard : std::atoi(wanted);
}

std::vector<int> seeds_and(int special) {
  std::vector<int> out{special};
  for (int seed = 1; seed <= seeds(35); ++seed) out.push_back(seed);
  return out;
}

int requests_of_an_apply(std::size_t axes, std::size_t buses, Extent extent) {
  Fleet fleet(axes, buses);
  if (extent == Extent::all) fleet.give_pdos_and_heartbeats();
  fleet.trouble({});
  EXPECT_TRUE(fleet.apply());
  return fleet.requests();
}

/// The promise, for one axis after an apply that answered.
void expect_promise(TroubledFleet& world, const report::Value& answer, std::size_t axis) {
  const auto result = Fleet::result_of(answer, axis);
  const bool undone = result == "put back, because another axis failed";
  if (result == "applied" || result == "nothing to do")
    EXPECT_TRUE(world.is_as_wanted(axis)) << result;
  else
    EXPECT_TRUE(undone || world.is_named(axis)) << result;
  const bool said_before =
      undone || result == "put back: every value is as it was before" || result == "not changed";
  EXPECT_TRUE(!said_before || world.is_as_before(axis)) << result;
  const bool is_either = world.is_as_wanted(axis) || world.is_as_before(axis);
  EXPECT_TRUE(is_either || result == "failed; see the errors") << result;
}

TEST(CabinetTrouble, LeavesEachAxisAsWantedOrAsBeforeOrNamed) {
  const std::array requests{requests_of_an_apply(5, 2, Extent::parameters),
                            requests_of_an_apply(5, 2, Extent::all)};
  EXPECT_GT(requests[1], requests[0] + 100);
  int applied = 0;
  int failed = 0;
  // 268: a drive that restarts while it stores has forgotten what was read back already.
  for (int seed : seeds_and(268)) {
    SCOPED_TRACE(seed);
    const auto extent = extent_of(seed);
    TroubledFleet world(5, 2, kExtents[extent]);
    world.fleet.trouble(trouble_of(static_cast<unsigned>(seed), requests[extent]),
                        static_cast<std::size_t>(seed) % 2);
    ApplyOptions options;
    const auto answer = world.fleet.apply(options);
    world.fleet.heal();
    if (!answer) {
      for (std::size_t i = 0; i < world.fleet.size(); ++i) EXPECT_TRUE(world.is_as_before(i));
    } else {
      for (std::size_t i = 0; i < world.fleet.size(); ++i) {
        expect_promise(world, *answer, i);
        ++(Fleet::result_of(*answer, i) == "applied" ? applied : failed);
      }
    }
    world.finish();
  }
  EXPECT_GT(applied, 30);
  EXPECT_GT(failed, 30);
}

TEST(CabinetTrouble, AllOrNothingIsAllOrNothing) {
  const std::array requests{requests_of_an_apply(5, 2, Extent::parameters),
                            requests_of_an_apply(5, 2, Extent::all)};
  int put_back = 0;
  std::string ends;
  for (int seed = 1; seed <= seeds(21); ++seed) {
    // Of a drive that stays silent and a bus that stays lost nothing can be put back.
    if (seed % 7 == 3 || seed % 7 == 5 || seed % 7 == 0) continue;
    SCOPED_TRACE(seed);
    const auto extent = extent_of(seed);
    TroubledFleet world(5, 2, kExtents[extent]);
    world.fleet.trouble(trouble_of(static_cast<unsigned>(seed), requests[extent]),
                        static_cast<std::size_t>(seed) % 2);
    ApplyOptions options;
    options.all_or_nothing = true;
    const auto answer = world.fleet.apply(options);
    world.fleet.heal();
    std::size_t wanted = 0;
    std::size_t named = 0;
    for (std::size_t i = 0; i < world.fleet.size(); ++i) {
      if (answer) expect_promise(world, *answer, i);
      if (world.is_as_wanted(i)) ++wanted;
      if (answer && Fleet::result_of(*answer, i) == "failed; see the errors") ++named;
      EXPECT_TRUE(answer || world.is_as_before(i));
    }
    EXPECT_TRUE(wanted == world.fleet.size() || named > 0 || wanted == 0) << wanted;
    if (wanted == 0) ++put_back;
    ends += fmt::format(" {}: {} as wanted, {} failed;", seed, wanted, named);
    world.finish();
  }
  // Six of twelve; which bus is further when the trouble comes, the threads decide.
  EXPECT_GT(put_back, 3) << ends;
}

TEST(CabinetTrouble, AnApplyThatIsKilledAtAnyStepIsGoneOnWith) {
  const auto requests = requests_of_an_apply(5, 1, Extent::all);
  int cut_off = 0;
  const int every = seeds(0) > 0 ? 1 : requests / 31;
  for (int step = 0; step < requests; step += every) {
    SCOPED_TRACE(step);
    TroubledFleet world(5, 1, Extent::all);
    world.fleet.trouble({.kill_at = step});
    EXPECT_THROW((void)world.fleet.apply(), ProcessEnds);
    world.fleet.desk.errors.clear();
    for (std::size_t i = 0; i < world.fleet.size(); ++i) {
      if (world.is_cut_off(i))
        ++cut_off;
      else
        EXPECT_TRUE(world.is_as_before(i) || world.is_as_wanted(i)) << "written without a journal";
    }
    if (world.any_cut_off()) {
      world.fleet.heal();
      const auto refused = world.fleet.look();
      for (std::size_t i = 0; i < world.fleet.size(); ++i) EXPECT_EQ(!refused[i].plan, world.is_cut_off(i));
    }
    world.finish();
  }
  EXPECT_GT(cut_off, 8);
}

TEST(CabinetTrouble, AnApplyThatIsKilledIsNotGoneOnWithInTheDriveThatReplacesItsOwn) {
  TroubledFleet world(1, 1, Extent::parameters);
  auto& fleet = world.fleet;
  const auto exchange = [&](std::uint32_t serial) {
    fleet.heal();
    fleet.drive(0).enable_lss(serial);
    fleet.power_cycle();
  };
  exchange(1);
  for (int step = 0; !world.is_cut_off(0) || world.is_as_before(0); ++step) {
    ASSERT_LT(step, 500);
    fs::remove(settings::journal_of(before_file(fleet.cabinet, fleet.cabinet.axes[0])));
    fleet.trouble({.kill_at = step});
    EXPECT_THROW((void)fleet.apply(), ProcessEnds);
  }
  exchange(2);
  const auto held = fleet.held(0, world.wanted[0]);
  ApplyOptions resume;
  resume.resume = true;
  (void)fleet.apply(resume);
  ASSERT_EQ(fleet.desk.errors.size(), 1U);
  EXPECT_NE(
      fleet.desk.errors[0].message.text().find("was of another drive: its serial number (1018h:04) differs"),
      std::string::npos)
      << fleet.desk.errors[0].message.text();
  EXPECT_EQ(fleet.held(0, world.wanted[0]), held);
  EXPECT_TRUE(world.is_cut_off(0));
  // Without it the new drive gets what the file says, and the old one's notes stay.
  const auto applied = fleet.apply();
  ASSERT_TRUE(applied && fleet.desk.errors.empty());
  EXPECT_TRUE(world.is_as_wanted(0));
  EXPECT_TRUE(fs::exists(fleet.folder() / "cabinet.toml.before-axis1-drive-2.json"));
  EXPECT_FALSE(fs::exists(fleet.folder() / "cabinet.toml.wanted-axis1-drive-2.json"));
  EXPECT_TRUE(world.is_cut_off(0));
  exchange(1);
  world.finish();
}

}  // namespace
}  // namespace servoctl::cabinet
