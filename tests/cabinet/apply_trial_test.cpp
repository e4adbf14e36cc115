// Drives that worked with trials in their RAM: an apply that fails, or is undone, puts none of them in the
// flash.
#include <gtest/gtest.h>

#include "drive/quantity.hpp"
#include "fleet_checks.hpp"

namespace servoctl::cabinet {
namespace {

constexpr std::string_view kFlashChanged = "put back, but its flash may not be as it was; see the errors";

/// Two axes of five have a switch between RAM and flash, and work with trials.
class TriedFleet {
 public:
  TriedFleet() : fleet(5) {
    for (const auto& look : fleet.look()) wanted.push_back(wanted_of(look));
    flash = held();
    write(3, "0x2005:3", 0);
    write(3, "0x2001:1", 70);
    write(3, "0x2001:2", 110);
    write(4, "Fn_99", 1);
    write(4, "Fn_33", 500);
    write(4, "Fn_3A", 7);
    before = held();
  }
  std::vector<session::Values> held() {
    std::vector<session::Values> out;
    for (std::size_t i = 0; i < fleet.size(); ++i) out.push_back(fleet.held(i, wanted[i]));
    return out;
  }
  /// After power-off; true when the flash of the axis is as it was.
  bool expect_no_trial(std::size_t axis) {
    const auto now = fleet.held(axis, wanted[axis]);
    bool same = true;
    for (const auto& [object, bytes] : now) {
      if (!session::is_known_to_keep(family_of(fleet.cabinet.axes[axis].family), object)) continue;
      EXPECT_TRUE(bytes == flash[axis].at(object) || bytes == wanted[axis].at(object))
          << fleet.cabinet.axes[axis].family << " " << to_string(object);
      same = same && bytes == flash[axis].at(object);
    }
    return same;
  }

  Fleet fleet;
  std::vector<session::Values> wanted;
  std::vector<session::Values> flash;
  std::vector<session::Values> before;

 private:
  void write(std::size_t axis, const char* name, std::int64_t value) {
    const auto node = fleet.cabinet.axes[axis].node;
    const auto target = drive::resolve(&family_of(fleet.cabinet.axes[axis].family), name).value();
    const auto data = od::encode(drive::meaning(target, node).type, od::Value(value)).value();
    ASSERT_TRUE(fleet.session(axis).download(node, target.address, data)) << name;
  }
};

/// With trouble at steps all over an apply; how often an axis ended with another flash.
int put_back_at_every_step(const ApplyOptions& options, int BusTrouble::*kind) {
  TriedFleet measure;
  measure.fleet.trouble({});
  EXPECT_TRUE(measure.fleet.apply(options));
  const int requests = measure.fleet.requests();
  int changed = 0;
  for (int step = 0; step < requests; step += 5) {
    SCOPED_TRACE(step);
    TriedFleet world;
    BusTrouble trouble;
    trouble.*kind = step;
    world.fleet.trouble(trouble);
    const auto answer = world.fleet.apply(options);
    world.fleet.heal();
    const auto now = world.held();
    world.fleet.power_cycle();
    for (const std::size_t axis : {3U, 4U}) {
      const bool same = world.expect_no_trial(axis);
      if (!answer) {
        EXPECT_TRUE(same);
        continue;
      }
      const auto result = Fleet::result_of(*answer, axis);
      SCOPED_TRACE(result);
      if (result == kFlashChanged) {
        ++changed;
        EXPECT_EQ(now[axis], world.before[axis]);
        EXPECT_TRUE(std::any_of(
            world.fleet.desk.errors.begin(), world.fleet.desk.errors.end(), [&](const Error& error) {
              return error.message.text().find(world.fleet.cabinet.axes[axis].name) != std::string::npos &&
                     error.message.text().find("its flash was not put back") != std::string::npos;
            }));
      } else if (!same) {
        EXPECT_TRUE(result.starts_with("applied")) << "nobody is told";
      }
    }
  }
  return changed;
}

TEST(CabinetTrial, OfADriveThatWorksInItsRamIsNotStoredByAnApplyThatFails) {
  EXPECT_GT(put_back_at_every_step({}, &BusTrouble::abort_at), 0);
  EXPECT_GT(put_back_at_every_step({}, &BusTrouble::cancel_at), 0);
}

TEST(CabinetTrial, OfADriveThatWorksInItsRamIsNotStoredByAnUndo) {
  ApplyOptions options;
  options.all_or_nothing = true;
  EXPECT_GT(put_back_at_every_step(options, &BusTrouble::abort_at), 5);
}

}  // namespace
}  // namespace servoctl::cabinet
