// What is no number: a drive may hold it, and a file may say it.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/cli/backup_world.hpp"

namespace servoctl::cli {
namespace {

/// 7FC00000h, as the dm family keeps a gain (KP of its speed loop, 2003h).
const Bytes kNoNumber{0x00, 0x00, 0xC0, 0x7F};
const Bytes kInfinity{0x00, 0x00, 0x80, 0x7F};

std::vector<ObjectAddress> floats() {
  std::vector<ObjectAddress> out;
  for (const auto& setting : drive::settings_of(profile_of("dm")))
    if (setting.left_out.empty() && setting.entry->encoding != od::Encoding::plain)
      out.push_back(setting.entry->address);
  return out;
}

std::map<ObjectAddress, Bytes> values_of(const Backup& backup) {
  std::map<ObjectAddress, Bytes> out;
  for (const auto& entry : backup.entries)
    if (entry.bytes) out.emplace(entry.object, *entry.bytes);
  return out;
}

TEST(BackupFloat, OfADriveThatHoldsNoNumberLeavesThatOutAndKeepsTheOthers) {
  const auto objects = floats();
  ASSERT_GT(objects.size(), 2U);
  World plain("dm", {});
  const auto whole = values_of(plain.backup());
  for (const auto& bits : {kNoNumber, kInfinity}) {
    World world("dm", {{objects[1], bits}});
    const auto backup = world.backup();
    const auto kept = values_of(backup);
    EXPECT_EQ(kept.size() + 1, whole.size());
    EXPECT_EQ(kept.count(objects[1]), 0U);
    const auto left = std::find_if(backup.entries.begin(), backup.entries.end(),
                                   [&](const auto& entry) { return entry.object == objects[1]; });
    ASSERT_NE(left, backup.entries.end());
    EXPECT_NE(left->left_out.find("infinity or of no number (NaN)"), std::string::npos) << left->left_out;
  }
}

/// What a backup of servoctl holds besides is put back; its checksum proves that a drive held all of it.
TEST(BackupFloat, AFileThatSaysNoNumberWritesNone) {
  const auto objects = floats();
  for (const auto& bits : {kNoNumber, kInfinity}) {
    for (const auto format :
         {BackupFormat::json, BackupFormat::csv, BackupFormat::dcf, BackupFormat::batch}) {
      SCOPED_TRACE(fmt::format("format {}", static_cast<int>(format)));
      World world("dm", {});
      auto backup = world.backup();
      const auto held = world.values(backup);
      const Bytes one{0, 0, 0x80, 0x3F};
      for (auto& entry : backup.entries) {
        if (entry.object == objects[1]) entry.bytes = bits;
        if (entry.object == objects[2]) entry.bytes = one;
      }
      const auto text = world.text(backup, format);
      ASSERT_TRUE(text) << text.error().message.text();
      const auto read = world.read(*text, format);
      if (format != BackupFormat::json) {
        EXPECT_FALSE(read && world.restore(*read));
        EXPECT_EQ(world.values(backup), held);
        continue;
      }
      ASSERT_TRUE(read) << read.error().message.text();
      ASSERT_TRUE(world.restore(*read));
      auto wanted = held;
      wanted[objects[2]] = one;
      EXPECT_EQ(world.values(backup), wanted);
      const auto& errors = world.context.errors;
      ASSERT_EQ(errors.size(), 1U) << "what was left as it is, is an error";
      EXPECT_NE(errors[0].message.text().find("infinity or of no number (NaN)"), std::string::npos)
          << errors[0].message.text();
    }
  }
}

}  // namespace
}  // namespace servoctl::cli
