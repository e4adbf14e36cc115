// A restore whose process is killed at any step can be gone on with, and can be undone.
#include <gtest/gtest.h>

#include <algorithm>

#include "restoring_world.hpp"

namespace servoctl::settings {
namespace {

class KilledRestore : public testing::TestWithParam<Case> {
 protected:
  RestoringOptions options() const {
    RestoringOptions out;
    out.keep = true;
    out.unlock = GetParam().unlock;
    return out;
  }
};

TEST_P(KilledRestore, IsGoneOnWithFromAnyStep) {
  World measure(GetParam());
  ASSERT_TRUE(measure.run(measure.backup, "drive.json", measure.saved(), options(), -1));
  EXPECT_FALSE(fs::exists(journal_of(measure.saved())));
  int cut_off = 0;
  for (int step = 0; step < measure.frames; ++step) {
    SCOPED_TRACE(step);
    World world(GetParam());
    ASSERT_FALSE(world.run(world.backup, "drive.json", world.saved(), options(), step));
    if (!fs::exists(journal_of(world.saved()))) {
      EXPECT_EQ(world.values(), world.before) << "written without a journal";
      continue;
    }
    ++cut_off;
    // The options are those it was begun with, whatever is said now.
    RestoringOptions resume;
    resume.resume = true;
    ASSERT_TRUE(world.run(world.backup, "drive.json", world.saved(), resume, -1));
    EXPECT_FALSE(fs::exists(journal_of(world.saved())));
    EXPECT_EQ(world.means(), world.means_before);
    world.power_cycle();
    world.expect_values_of_backup();
  }
  EXPECT_GT(cut_off, 5);
}

TEST_P(KilledRestore, IsUndoneFromAnyStep) {
  World measure(GetParam());
  ASSERT_TRUE(measure.run(measure.backup, "drive.json", measure.saved(), options(), -1));
  for (int step = 0; step < measure.frames; ++step) {
    SCOPED_TRACE(step);
    World world(GetParam());
    ASSERT_FALSE(world.run(world.backup, "drive.json", world.saved(), options(), step));
    if (!fs::exists(journal_of(world.saved()))) continue;
    const auto back = read_backup(world.saved());
    ASSERT_TRUE(back) << back.error().message.text();
    ASSERT_TRUE(world.run(*back, "before", world.saved().string() + ".before-node-1.json", {}, -1,
                          journal_of(world.saved())));
    EXPECT_FALSE(fs::exists(journal_of(world.saved())));
    EXPECT_EQ(world.values(), world.before);
    EXPECT_EQ(world.means(), world.means_before);
    world.power_cycle();
    EXPECT_EQ(world.values(), world.before);
  }
}

TEST_P(KilledRestore, IsRefusedWhereTheDriveHasChangedSinceItWasAgreedTo) {
  World world(GetParam());
  auto how = options();
  how.expected = world.values();
  how.expected->begin()->second.front() ^= 1U;
  const auto object = how.expected->begin()->first;
  const auto refused = world.put(how);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_EQ(refused.error().object, object);
  EXPECT_NE(refused.error().message.text().find("has changed since the plan was made"), std::string::npos);
  EXPECT_EQ(world.values(), world.before);
  EXPECT_FALSE(fs::exists(world.saved()));
  how.expected = world.values();
  how.expected->erase(object);
  EXPECT_FALSE(world.put(how)) << "an object more than was agreed to";
  how.expected = world.values();
  how.expected->emplace(ObjectAddress{0x6502, 0}, Bytes{1});
  EXPECT_FALSE(world.put(how)) << "an object less than was agreed to";
  EXPECT_EQ(world.values(), world.before);
  how.expected = world.values();
  const auto done = world.put(how);
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_FALSE(done->failed);
  world.expect_values_of_backup();
}

bool is_told(const World& world, const char* text) {
  return std::any_of(world.notices.begin(), world.notices.end(),
                     [&](const auto& notice) { return notice.text().find(text) != std::string::npos; });
}

TEST(KeptAddress, IsNamedWhereTheBackupHasAnother) {
  World world({"gsd600", {{"Pn0214", 450}, {"Pn0048", 5}, {"Pn0049", 7}}, false});
  ASSERT_TRUE(world.put({}));
  EXPECT_TRUE(is_told(world, "node 1: Pn0048 CAN bitrate stays 8 1000 kbit/s; drive.json has 5 250 kbit/s"));
  EXPECT_TRUE(is_told(world, "node 1: Pn0049 CAN node-ID stays 1; drive.json has 7, which only"));
  EXPECT_EQ(world.values().at({0x2000, 0x32}), world.before.at({0x2000, 0x32}));
  world.backup.identity.node = 7;
  ASSERT_TRUE(world.put({}));
  EXPECT_FALSE(is_told(world, "node-ID stays")) << "that of another drive";
  EXPECT_TRUE(is_told(world, "bitrate stays"));
  world.chinese = true;
  ASSERT_TRUE(world.put({}));
  EXPECT_TRUE(is_told(world, "node 1: Pn0048 CAN 总线波特率设置 stays"));
  world.chinese = false;
  RestoringOptions whole;
  whole.choice.with_address = true;
  ASSERT_TRUE(world.put(whole));
  EXPECT_FALSE(is_told(world, " stays "));
}

/// How a restore says that it ended.
std::string ended(const Result<Restored>& done) {
  const auto* state = done ? report::find(done->answer, "result") : nullptr;
  return state == nullptr ? "" : std::get<std::string>(state->data());
}

TEST(KeptAddress, IsOnlyNamedWhereItIsAnotherAndAnAddress) {
  World world({"gsd600", {{"Pn0214", 450}, {"Pn0048", 5}, {"Pn0049", 7}}, false});
  ASSERT_TRUE(world.put({}));
  EXPECT_FALSE(is_told(world, "Pn0214")) << "it is restored";
  EXPECT_EQ(ended(world.put({})), "nothing else differs");
  for (auto& entry : world.backup.entries) entry.bytes = world.values().at(entry.object);
  EXPECT_EQ(ended(world.put({})), "nothing differs");
  EXPECT_FALSE(is_told(world, " stays "));
}

INSTANTIATE_TEST_SUITE_P(
    Families, KilledRestore,
    testing::Values(Case{"gsd600", {{"Pn0214", 450}, {"Pn0202", 321}, {"605Ah", 1}, {"6065h", 65536}}, false},
                    Case{"ts", {{"Fn_33", 120}, {"Fn_3A", 3}, {"Fn_12E", 50}}, true},
                    Case{"sv2", {{"2001h:1", 60}, {"2001h:2", 90}}, false}),
    [](const auto& each) { return std::string(each.param.family); });

/// As `param set` does, which asks for it alone.
TEST(Restoring, NamesWhatMayEnergiseTheMotorInItsQuestion) {
  World harmless({"gsd600", {{"Pn0214", 450}}, false});
  ASSERT_TRUE(harmless.put({}));
  ASSERT_EQ(harmless.questions.size(), 1U);
  EXPECT_EQ(harmless.questions[0], "Write 1 value of drive.json to node 1?");
  World world({"gsd600", {{"Pn0600", 1}, {"Pn0214", 450}}, false});
  ASSERT_TRUE(world.put({}));
  ASSERT_EQ(world.questions.size(), 1U);
  EXPECT_NE(world.questions[0].find("Pn0600"), std::string::npos) << world.questions[0];
  EXPECT_NE(world.questions[0].find("the motor may be energised"), std::string::npos) << world.questions[0];
  const auto told = std::count_if(world.notices.begin(), world.notices.end(), [](const Message& notice) {
    return notice.text().find("`param set Pn0600=0 -n 1`") != std::string::npos;
  });
  EXPECT_EQ(told, 1);
  // What it holds already is no news.
  ASSERT_TRUE(world.put({}));
  EXPECT_EQ(world.questions.size(), 1U);
}

}  // namespace
}  // namespace servoctl::settings
