// What od::write_eds() writes of each family is read again as it was.
#include "od/eds_writer.hpp"

#include <gtest/gtest.h>

#include "drive/profile.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::drive {
namespace {

std::string value_of(const std::optional<od::NodeValue>& value) {
  return value ? (value->plus_node_id ? "$NODEID+" : "") + od::to_string(value->value) : "-";
}

TEST(EdsWriter, WritesEachFamilySoThatItIsReadAgainAsItWas) {
  for (const auto* family : {"cia402", "da200", "dm", "gsd600", "sv2", "ts"}) {
    const auto profile = load_profile(family, kFolders);
    ASSERT_TRUE(profile) << family;
    const od::EdsHead head{.file_name = "x.eds", .description = "", .date = "11-28-2026", .time = "06:12PM"};
    od::DeviceInfo device;
    device.vendor_number = 0x195;
    const auto text = od::write_eds(head, device, profile->dictionary);
    const auto read = od::read_eds(text, "x.eds");
    ASSERT_TRUE(read) << family;
    EXPECT_EQ(read->error_count(), 0U) << family << " " << od::to_string(read->diagnostics.front(), family);
    EXPECT_EQ(read->device.vendor_number, 0x195U);
    ASSERT_EQ(read->dictionary.entry_count(), profile->dictionary.entry_count()) << family;
    for (const auto& object : profile->dictionary.objects())
      for (const auto& entry : object.entries) {
        const auto* again = read->dictionary.find(entry.address);
        ASSERT_NE(again, nullptr) << family << " " << to_string(entry.address);
        EXPECT_EQ(again->type, entry.type) << family << " " << to_string(entry.address);
        EXPECT_EQ(again->access, entry.access) << family << " " << to_string(entry.address);
        EXPECT_EQ(again->pdo == od::PdoMapping::no, entry.pdo == od::PdoMapping::no)
            << to_string(entry.address);
        EXPECT_EQ(value_of(again->default_value), value_of(entry.default_value)) << to_string(entry.address);
        EXPECT_EQ(value_of(again->low), value_of(entry.low)) << to_string(entry.address);
        EXPECT_EQ(value_of(again->high), value_of(entry.high)) << to_string(entry.address);
      }
  }
}

TEST(EdsWriter, WritesTimesAsCia306Does) {
  EXPECT_EQ(od::eds_time("2026-11-18T11:06:40Z").date, "11-18-2026");
  EXPECT_EQ(od::eds_time("2026-11-18T11:06:40Z").time, "11:06AM");
  EXPECT_EQ(od::eds_time("2026-11-18T00:06:40Z").time, "12:06AM");
  EXPECT_EQ(od::eds_time("").date, "");
}

TEST(EdsWriter, KeepsALineBreakOfANameFromBeginningAKey) {
  od::Dictionary dictionary;
  od::Object object;
  object.index = 0x2000;
  object.name = "a\nAccessType=rw";
  object.entries.emplace_back().address = {0x2000, 0};
  object.entries.back().access = od::Access::ro;
  dictionary.add(object);
  const auto read = od::read_eds(od::write_eds({}, {}, dictionary), "x.eds");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->dictionary.find({0x2000, 0})->access, od::Access::ro);
}

}  // namespace
}  // namespace servoctl::drive
