// Backup and restore on a network that is no CAN bus.
#include <gtest/gtest.h>

#include <filesystem>

#include "memory_network.hpp"
#include "memory_objects.hpp"
#include "session/restore.hpp"
#include "session/snapshot.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

/// A drive of each family whose objects stand in memory.
class DriveInMemory : public testing::TestWithParam<const char*> {
 protected:
  DriveInMemory()
      : profile(drive::load_profile(GetParam(), kFolders).value()), objects(objects_of(profile, 1)) {
    auto owned = std::make_unique<MemoryNetwork>();
    network = owned.get();
    network->add(1, objects);
    session.emplace(std::move(owned), "memory", Options{});
  }

  drive::Profile profile;
  MemoryObjects objects;
  MemoryNetwork* network = nullptr;
  std::optional<Session> session;
};

TEST_P(DriveInMemory, IsBackedUpAndRestored) {
  const std::uint8_t nodes[] = {1};
  const auto taken = take_snapshots(*session, profile, nodes, {});
  ASSERT_TRUE(taken.front()) << taken.front().error().message.text();
  Values before;
  for (const auto& entry : taken.front()->entries)
    if (entry.bytes) before.emplace(entry.object, *entry.bytes);
  ASSERT_GT(before.size(), 20U);
  Values changed = before;
  std::size_t count = 0;
  for (auto& [object, bytes] : changed)
    if (object.index >= 0x2000 && !bytes.empty() && ++count <= 10) bytes[0] ^= 1U;
  ASSERT_GT(count, 0U);
  const auto there = restore(*session, &profile, 1, before, changed, {});
  ASSERT_FALSE(there.failure) << there.failure->message.text();
  EXPECT_TRUE(there.all_written);
  for (const auto& [object, bytes] : changed) EXPECT_EQ(objects.values[object], bytes) << to_string(object);
  const auto back = restore(*session, &profile, 1, changed, before, {});
  ASSERT_FALSE(back.failure) << back.failure->message.text();
  EXPECT_EQ(back.writes, there.writes);
  for (const auto& [object, bytes] : before) EXPECT_EQ(objects.values[object], bytes) << to_string(object);
}

TEST_P(DriveInMemory, IsAsItWasWhenARestoreIsRefusedInTheMiddle) {
  const std::uint8_t nodes[] = {1};
  const auto taken = take_snapshots(*session, profile, nodes, {});
  ASSERT_TRUE(taken.front());
  Values before;
  for (const auto& entry : taken.front()->entries)
    if (entry.bytes && entry.object.index >= 0x2000) before.emplace(entry.object, *entry.bytes);
  ASSERT_GT(before.size(), 1U);
  Values changed = before;
  for (auto& [object, bytes] : changed)
    if (!bytes.empty()) bytes[0] ^= 1U;
  objects.read_only.insert(std::prev(before.end())->first);
  const auto outcome = restore(*session, &profile, 1, before, changed, {});
  ASSERT_TRUE(outcome.failure);
  EXPECT_EQ(outcome.failure->abort_code, 0x0601'0002U);
  EXPECT_TRUE(outcome.rolled_back);
  for (const auto& [object, bytes] : before) EXPECT_EQ(objects.values[object], bytes) << to_string(object);
}

INSTANTIATE_TEST_SUITE_P(OnNoBus, DriveInMemory,
                         testing::Values("gsd600", "dm", "da200", "ts", "sv2", "cia402"),
                         [](const auto& family) { return std::string(family.param); });

}  // namespace
}  // namespace servoctl::session
