// A new drive in the place of an old one: its node, its values, and whoever else is left alone.
#include "cabinet/swap.hpp"

#include <gtest/gtest.h>

#include "base/file.hpp"
#include "drive/naming.hpp"
#include "fleet.hpp"
#include "session/snapshot.hpp"
#include "settings/backup_file.hpp"

namespace servoctl::cabinet {
namespace {

Result<report::Value> swap(Fleet& fleet, std::size_t axis, std::optional<std::uint8_t> from,
                           const fs::path& backup = {}) {
  fleet.desk.errors.clear();
  fleet.desk.notices.clear();
  const auto families = drive::find_families(drive_data());
  SwapOptions options;
  options.from = from;
  options.backup = backup;
  options.apply.choice = {.unlisted = false, .families = families};
  return swap_axis(fleet.desk, fleet.cabinet, fleet.stations()[axis], options);
}

std::string told(const Fleet& fleet) {
  std::string out;
  for (const auto& notice : fleet.desk.notices) out += notice.text() + "\n";
  for (const auto& error : fleet.desk.errors) out += "error: " + error.message.text() + "\n";
  return out;
}

/// da200, dm and gsd600 at nodes 1 to 3: new drives, whose places are others by the file.
class CabinetSwap : public testing::Test {
 protected:
  CabinetSwap() {
    for (auto& axis : fleet.cabinet.axes) {
      axis.node = static_cast<std::uint8_t>(axis.node + 40);
      axis.serial = 4711;
    }
  }
  Fleet fleet{3};
};

TEST_F(CabinetSwap, GivesTheNewDriveTheNodeAndTheValuesOfTheAxis) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto from = static_cast<std::uint8_t>(i + 1);
    const auto done = swap(fleet, i, from);
    ASSERT_TRUE(done) << done.error().message.text();
    EXPECT_TRUE(fleet.desk.errors.empty()) << told(fleet);
    EXPECT_EQ(fleet.drive(i).node(), from + 40);
    EXPECT_NE(told(fleet).find("home position"), std::string::npos) << told(fleet);
    const bool has_serial = fleet.cabinet.axes[i].family != "gsd600";
    EXPECT_NE(
        told(fleet).find(has_serial ? "change `serial` to" : "take `serial` out, the new drive tells none"),
        std::string::npos)
        << told(fleet);
  }
  for (auto& axis : fleet.cabinet.axes) axis.serial.reset();
  EXPECT_EQ(fleet.different(), 0U);
}

TEST_F(CabinetSwap, ADriveThatIsProvenToBeOfAnotherFamilyIsNotTakenForTheOneOfItsNode) {
  for (auto& axis : fleet.cabinet.axes) axis.serial.reset();
  fleet.cabinet.axes[2].node = 1;  // The gsd600 of the file; a da200 is there.
  const auto done = swap(fleet, 0, 1);
  EXPECT_TRUE(done) << done.error().message.text();
  EXPECT_EQ(fleet.drive(0).node(), 41);
}

TEST_F(CabinetSwap, WhereNobodyIsBothNodesAreNamed) {
  const auto done = swap(fleet, 0, 9);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.text().find("neither node-ID 9 nor node-ID 41 answers"), std::string::npos)
      << done.error().message.text();
}

TEST_F(CabinetSwap, DoneASecondTimeMovesNobody) {
  ASSERT_TRUE(swap(fleet, 0, 1));
  const auto again = swap(fleet, 0, 1);
  ASSERT_TRUE(again) << again.error().message.text();
  EXPECT_TRUE(fleet.desk.errors.empty()) << told(fleet);
  EXPECT_EQ(fleet.drive(0).node(), 41);
}

TEST_F(CabinetSwap, CutOffBehindTheMoveIsRepeated) {
  for (int cancel_at = 20; cancel_at < 120; cancel_at += 7) {
    Fleet other(1);
    other.cabinet.axes[0].node = 41;
    other.trouble({.cancel_at = cancel_at});
    (void)swap(other, 0, 1);
    other.heal();
    auto done = swap(other, 0, 1);
    if (!done && done.error().hint.text().find("resume") != std::string::npos) continue;  // As apply.
    ASSERT_TRUE(done) << cancel_at << ": " << done.error().message.text();
    if (other.drive(0).node() == 1) other.command("8100");
    EXPECT_EQ(other.drive(0).node(), 41) << cancel_at;
    EXPECT_EQ(other.different(), 0U) << cancel_at;
  }
}

TEST_F(CabinetSwap, RefusesADriveOfAnotherFamily) {
  const auto done = swap(fleet, 0, 3);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::refused);
  EXPECT_EQ(fleet.drive(2).node(), 3);
}

TEST_F(CabinetSwap, RefusesWhileTheOldDriveIsThere) {
  Fleet two(6);  // Two of da200, at nodes 1 and 6.
  const auto done = swap(two, 0, 6);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::refused);
  EXPECT_EQ(two.drive(5).node(), 6);
}

TEST_F(CabinetSwap, RefusesADriveThatHasAPlaceInTheFileAlready) {
  // da200 tells the serial number 16.
  fleet.cabinet.axes[1].serial = 16;
  const auto known = swap(fleet, 0, 1);
  ASSERT_FALSE(known);
  EXPECT_NE(known.error().message.text().find("that of axis axis2"), std::string::npos)
      << known.error().message.text();
  fleet.cabinet.axes[1].serial.reset();
  fleet.cabinet.axes[1].node = 1;
  fleet.cabinet.axes[1].family = "da200";
  const auto listed = swap(fleet, 0, 1);
  ASSERT_FALSE(listed);
  EXPECT_EQ(listed.error().code, Errc::refused);
  EXPECT_EQ(fleet.drive(0).node(), 1);
  fleet.cabinet.axes[1].serial = 815;
  EXPECT_TRUE(swap(fleet, 0, 1)) << "another serial number tells that it is another drive";
}

TEST_F(CabinetSwap, NobodySaysYesAndNothingIsMoved) {
  show::Unwilling unwilling;
  fleet.desk.audience = &unwilling;
  const auto done = swap(fleet, 0, 1);
  ASSERT_FALSE(done);
  EXPECT_EQ(fleet.drive(0).node(), 1);
}

TEST_F(CabinetSwap, IsOnlyShownByADryRun) {
  fleet.desk.dry_run = true;
  ASSERT_TRUE(swap(fleet, 0, 1));
  EXPECT_EQ(fleet.drive(0).node(), 1);
}

TEST_F(CabinetSwap, RestoresAllThatWasSavedWhereThereIsABackup) {
  auto& session = fleet.session(2);
  const auto& profile = family_of("gsd600");
  const std::uint8_t nodes[] = {3};
  show::Desk desk;
  desk.session = &session;
  desk.profile = &profile;
  const auto object = drive::resolve(&profile, "Pn0203").value().address;
  const auto before = session.upload(3, object).value();
  auto saved = before;
  saved[0] = static_cast<std::uint8_t>(saved[0] + 1);
  ASSERT_TRUE(session.download(3, object, saved));
  const auto snapshot = session::take_snapshots(session, profile, nodes, {}).front();
  ASSERT_TRUE(snapshot);
  ASSERT_TRUE(write_file_atomically(fleet.folder() / (fleet.cabinet.axes[2].name + ".json"),
                                    settings::backup_text(desk, settings::make_backup(desk, *snapshot))));
  ASSERT_TRUE(session.download(3, object, before));
  const auto done = swap(fleet, 2, 3, fleet.folder());
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_TRUE(fleet.desk.errors.empty()) << told(fleet);
  EXPECT_EQ(fleet.drive(2).node(), 43);
  EXPECT_EQ(fleet.drive(2).value(object), saved) << "not in the file, and in the backup";
}

}  // namespace
}  // namespace servoctl::cabinet
