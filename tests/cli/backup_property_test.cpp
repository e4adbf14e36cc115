// A backup that servoctl wrote is always one it takes: whatever a drive of any family holds.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <random>

#include "tests/cli/backup_world.hpp"

namespace servoctl::cli {
namespace {

using namespace std::chrono_literals;

/// A value of the type, with no thought of limits.
Bytes any_value(od::DataType type, std::mt19937& random) {
  auto size = od::size_of(type).value_or(random() % 12);
  Bytes out(size);
  for (auto& byte : out) byte = static_cast<std::uint8_t>(random());
  if (type == od::DataType::boolean) out[0] &= 1U;
  return out;
}

/// Something in half of all settings; what addresses the drive and its PDOs' records stay those of the
/// factory now and then, so that the drive is one that can be spoken to.
sim::Memory::Cells any_drive(const drive::Profile& profile, std::mt19937& random) {
  sim::Memory::Cells out;
  for (const auto& setting : drive::settings_of(profile)) {
    if (!setting.left_out.empty() || random() % 2 == 0) continue;
    const auto object = setting.entry->address;
    if (settings::is_address(&profile, object)) continue;
    // How it answers at all: heartbeats and SYNC of any length would only fill the bus.
    if (object.index >= 0x1000 && object.index < 0x1400) continue;
    out[object] = any_value(setting.entry->type, random);
  }
  return out;
}

class Families : public testing::TestWithParam<std::string> {};

TEST_P(Families, TakeBackWhatTheyHeldFromEveryFormat) {
  std::mt19937 random(2026);
  for (int round = 0; round < 6; ++round) {
    const auto& profile = profile_of(GetParam());
    const auto cells = any_drive(profile, random);
    World world(GetParam(), cells);
    const auto backup = world.backup();
    const auto held = world.values(backup);
    for (const auto format :
         {BackupFormat::json, BackupFormat::csv, BackupFormat::dcf, BackupFormat::batch}) {
      SCOPED_TRACE(fmt::format("round {}, format {}", round, static_cast<int>(format)));
      const auto text = world.text(backup, format);
      if (!text) continue;  // A family without data sheet has no DCF.
      const auto read = world.read(*text, format);
      ASSERT_TRUE(read) << read.error().message.text();
      const auto same = world.restore(*read);
      ASSERT_TRUE(same) << same.error().message.text();
      EXPECT_TRUE(world.context.errors.empty()) << world.context.errors.front().message.text();
      EXPECT_EQ(world.values(backup), held) << "nothing differed";
    }
  }
}

TEST_P(Families, PutWhatIsWithinLimitsIntoAFactoryDriveAndNameTheRest) {
  std::mt19937 random(7);
  for (int round = 0; round < 4; ++round) {
    World source(GetParam(), any_drive(profile_of(GetParam()), random));
    const auto backup = source.backup();
    World target(GetParam(), {});
    const auto read = target.read(source.text(backup, BackupFormat::json).value(), BackupFormat::json);
    ASSERT_TRUE(read) << read.error().message.text();
    auto one = *read;
    // One after the other: a drive may refuse what it held itself, in this state or beside other values.
    std::size_t taken = 0;
    for (const auto& entry : read->entries) {
      if (!entry.bytes) continue;
      one.entries = {entry};
      const auto done = target.restore(one);
      ASSERT_TRUE(done) << done.error().message.text();
      const bool same = target.drive().value(entry.object) == *entry.bytes;
      const bool told = !target.context.errors.empty();
      EXPECT_TRUE(same || told || settings::is_address(&profile_of(GetParam()), entry.object))
          << to_string(entry.object) << " was not written, and nothing says so";
      EXPECT_TRUE(told || !target.is_cut_off()) << to_string(entry.object);
      taken += same ? 1U : 0U;
    }
    EXPECT_GT(taken, read->entries.size() / 4);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Families,
                         testing::Values("gsd600", "dm", "da200", "ts", "sv2", "cia402", "lab"),
                         [](const auto& each) { return each.param; });

TEST(ABackup, LeavesOutACobIdThatNoDriveMayHaveAndIsTaken) {
  World world("dm", {{{0x1801, 1}, store_le(0x601, 4)}});
  ASSERT_EQ(load_le(world.drive().value({0x1801, 1})), 0x601U);
  const auto backup = world.backup();
  settings::tell_left_out(world.context, backup);
  ASSERT_EQ(world.context.notices.size(), 1U);
  EXPECT_NE(world.context.notices[0].text().find("CAN-ID 0x601 belongs to SDO"), std::string::npos)
      << world.context.notices[0].text();
  const auto done =
      world.restore(world.read(world.text(backup, BackupFormat::json).value(), BackupFormat::json).value());
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_TRUE(world.context.errors.empty());
}

}  // namespace
}  // namespace servoctl::cli
