// The inhibit time of a TPDO changes only while the PDO is invalid (CiA 301, 7.5.2.37). A file that names the
// inhibit time and not the COB-ID is restored all the same, and the COB-ID is as before.
#include <gtest/gtest.h>

#include "canopen/pdo.hpp"
#include "restoring_world.hpp"

namespace servoctl::settings {
namespace {

constexpr ObjectAddress kCobId{0x1800, 1};

class InhibitTimeAlone : public testing::TestWithParam<const char*> {
 protected:
  Case settings() const { return {GetParam(), {{"1800h:3", 250}}, false}; }
};

TEST_P(InhibitTimeAlone, IsRestoredWhileThePdoIsValid) {
  World world(settings());
  const auto before = world.read({kCobId}).at(kCobId);
  ASSERT_EQ(load_le(before) & canopen::kPdoInvalid, 0U);
  const auto done = world.put({});
  ASSERT_TRUE(done) << done.error().message.text();
  for (const auto& error : world.errors) ADD_FAILURE() << error.message.text();
  world.expect_values_of_backup();
  EXPECT_EQ(world.read({kCobId}).at(kCobId), before);
}

/// The COB-ID is as it was: nothing is said of it.
TEST(InhibitTime, IsKeptWithoutANoticeOfTheCobId) {
  World world({"gsd600", {{"1800h:3", 250}}, false});
  RestoringOptions keep;
  keep.keep = true;
  const auto done = world.put(keep);
  ASSERT_TRUE(done) << done.error().message.text();
  world.expect_values_of_backup();
  for (const auto& notice : world.notices)
    EXPECT_EQ(notice.text().find("0x1800:1"), std::string::npos) << notice.text();
}

TEST_P(InhibitTimeAlone, LeavesNoPdoInvalidWhereItsRestoreIsCutOff) {
  World measure(settings());
  ASSERT_TRUE(measure.run(measure.backup, "drive.json", measure.saved(), {}, -1));
  int cut_off = 0;
  for (int step = 0; step < 2 * measure.frames; ++step) {
    SCOPED_TRACE(step);
    const bool resumes = step % 2 == 0;
    World world(settings());
    const auto before = world.read({kCobId}).at(kCobId);
    ASSERT_FALSE(world.run(world.backup, "drive.json", world.saved(), {}, step / 2));
    if (!fs::exists(journal_of(world.saved()))) {
      EXPECT_EQ(world.read({kCobId}).at(kCobId), before) << "written without a journal";
      continue;
    }
    cut_off += world.read({kCobId}).at(kCobId) == before ? 0 : 1;
    if (resumes) {
      RestoringOptions resume;
      resume.resume = true;
      ASSERT_TRUE(world.run(world.backup, "drive.json", world.saved(), resume, -1));
      world.expect_values_of_backup();
    } else {
      const auto back = read_backup(world.saved());
      ASSERT_TRUE(back) << back.error().message.text();
      ASSERT_TRUE(world.run(*back, "before", world.saved().string() + ".before-node-1.json", {}, -1,
                            journal_of(world.saved())));
      EXPECT_EQ(world.values(), world.before);
    }
    EXPECT_EQ(world.read({kCobId}).at(kCobId), before);
  }
  EXPECT_EQ(cut_off > 0, GetParam() != std::string("ts")) << "the TS takes it while the PDO is valid (1771)";
}

INSTANTIATE_TEST_SUITE_P(Families, InhibitTimeAlone, testing::Values("cia402", "gsd600", "da200", "ts"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace servoctl::settings
