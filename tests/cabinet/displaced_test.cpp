// The drive of an axis at another node than the file says: found by its serial number, and given its node
// first.
#include "cabinet/displaced.hpp"

#include <gtest/gtest.h>

#include "fleet.hpp"
#include "tests/sim/commissioned.hpp"

namespace servoctl::cabinet {
namespace {

/// da200, dm, gsd600, sv2 and ts at nodes 1 to 5; the first, whose serial number is 16, is to be node 77.
class CabinetDisplaced : public testing::Test {
 protected:
  CabinetDisplaced() {
    fleet.cabinet.axes[0].node = 77;
    fleet.cabinet.axes[0].serial = 16;
    options.choice.families = families;
  }
  Result<report::Value> apply() { return fleet.apply(options); }
  std::string told() const {
    std::string out;
    for (const auto& error : fleet.desk.errors) out += error.message.text() + "; " + error.hint.text() + "\n";
    return out;
  }
  std::vector<drive::Family> families = drive::find_families(drive_data());
  Fleet fleet{6};
  ApplyOptions options;
};

TEST_F(CabinetDisplaced, APlanSaysWhereItIsAndWritesNothing) {
  fleet.cabinet.axes.pop_back();
  fleet.drive(5).wire_faults().silent = true;
  auto looks = fleet.look();
  const auto stations = fleet.stations();
  const auto found = find_displaced(fleet.desk, stations, {.families = families}, looks);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].at, 1);
  ASSERT_FALSE(looks[0].plan);
  EXPECT_EQ(looks[0].plan.error().code, Errc::negative);
  EXPECT_NE(looks[0].plan.error().message.text().find("(serial number 16 (0x00000010)) is at node-ID 1"),
            std::string::npos)
      << looks[0].plan.error().message.text();
  EXPECT_EQ(fleet.drive(0).node(), 1);
}

TEST_F(CabinetDisplaced, AnApplyGivesItItsNodeAndThenItsValues) {
  const auto done = apply();
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_EQ(told(), "");
  EXPECT_EQ(Fleet::results_of(*done), std::vector<std::string>(6, "applied"));
  EXPECT_EQ(fleet.drive(0).node(), 77);
  EXPECT_EQ(fleet.different(), 0U);
}

TEST_F(CabinetDisplaced, NobodyIsMovedWithoutConsent) {
  show::Unwilling nobody;
  fleet.desk.audience = &nobody;
  const auto refused = apply();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_EQ(fleet.drive(0).node(), 1);
  EXPECT_GT(fleet.look()[1].plan->different, 0U) << "and nothing was written to the others";
}

TEST_F(CabinetDisplaced, AllOrNothingMovesNobody) {
  options.all_or_nothing = true;
  const auto refused = apply();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.text().find("is at node-ID 1"), std::string::npos)
      << refused.error().message.text();
  EXPECT_EQ(fleet.drive(0).node(), 1);
}

TEST_F(CabinetDisplaced, ADriveWithoutASerialNumberInTheFileIsNotLookedFor) {
  fleet.cabinet.axes[0].serial.reset();
  ASSERT_TRUE(apply());
  EXPECT_NE(told().find("axis1"), std::string::npos) << told();
  EXPECT_EQ(told().find("is at node-ID"), std::string::npos) << told();
  EXPECT_EQ(fleet.drive(0).node(), 1);
}

TEST_F(CabinetDisplaced, TwoOfOneSerialNumberAreNotMoved) {
  fleet.cabinet.axes.pop_back();  // Its da200, at node 6, has the same number, and is at no axis now.
  ASSERT_TRUE(apply());
  EXPECT_EQ(told().find("is at node-ID"), std::string::npos) << told();
  EXPECT_EQ(fleet.drive(0).node(), 1);
  EXPECT_EQ(fleet.drive(5).node(), 6);
}

TEST_F(CabinetDisplaced, APlaceThatAnotherHasIsNotTaken) {
  fleet.cabinet.axes.erase(fleet.cabinet.axes.begin() + 2);
  fleet.cabinet.axes[0].node = 3;  // The gsd600 that is there is at no axis now.
  ASSERT_TRUE(apply());
  EXPECT_NE(told().find("axis1"), std::string::npos) << told();
  EXPECT_EQ(fleet.drive(0).node(), 1);
  EXPECT_EQ(fleet.drive(2).node(), 3);
}

TEST_F(CabinetDisplaced, AnEnergisedDriveStaysWhereItIs) {
  sim::commission(fleet.drive(0).model());
  for (const std::uint64_t word : {0x06U, 0x07U, 0x0FU})
    ASSERT_EQ(fleet.drive(0).model().write({0x6040, 0}, store_le(word, 2)), 0U);
  ASSERT_TRUE(apply());
  EXPECT_NE(told().find("energised"), std::string::npos) << told();
  EXPECT_EQ(fleet.drive(0).node(), 1);
}

}  // namespace
}  // namespace servoctl::cabinet
