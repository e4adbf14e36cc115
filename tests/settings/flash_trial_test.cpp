// A drive that works in its RAM and is told to keep other values: no trial goes to its flash, however the
// restore ends, and no sentence says that the flash is as it was when it is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "report/value.hpp"
#include "restoring_world.hpp"

namespace servoctl::settings {
namespace {

struct Family {
  Case settings;
  Setting to_ram;
  std::vector<Setting> trials;
};

const Family kTs{{"ts", {{"Fn_33", 120}, {"Fn_3A", 3}, {"Fn_12E", 50}}, false},
                 {"Fn_99", 1},
                 {{"Fn_33", 500}, {"Fn_3A", 7}, {"Fn_12E", 60}}};
const Family kSv2{
    {"sv2", {{"2001h:1", 60}, {"2001h:2", 90}}, false}, {"2005h:3", 0}, {{"2001h:1", 70}, {"2001h:2", 110}}};

/// A drive whose RAM holds trials, and whose flash holds `flash`.
class TrialWorld : public World {
 public:
  explicit TrialWorld(const Family& family)
      : World(family.settings), flash(before), switch_(family.to_ram.name) {
    write({family.to_ram});
    write(family.trials);
    before = values();
    means_before = means();
    for (const auto& entry : backup.entries) wanted.emplace(entry.object, *entry.bytes);
  }
  bool is_cut_off() const { return fs::exists(journal_of(saved())); }
  /// After power-off no value is a trial; true when the flash is as it was.
  bool expect_no_trial_after_power_off() {
    power_cycle();
    const auto now = values();
    for (const auto& [object, bytes] : now)
      EXPECT_TRUE(bytes == flash.at(object) || bytes == wanted.at(object)) << to_string(object);
    return now == flash;
  }
  bool is_told(std::string_view text) const {
    const auto has = [&](const auto& message) { return message.text().find(text) != std::string::npos; };
    return std::any_of(notices.begin(), notices.end(), has) ||
           std::any_of(errors.begin(), errors.end(), [&](const Error& error) { return has(error.message); });
  }

  ObjectAddress memory_switch() const { return drive::resolve(&profile(), switch_).value().address; }

  session::Values flash;
  session::Values wanted;

 private:
  const char* switch_;
};

class FlashTrial : public testing::TestWithParam<Family> {
 protected:
  static RestoringOptions keep() {
    RestoringOptions out;
    out.keep = true;
    return out;
  }
};

std::string result_of(const Restored& restored) {
  return report::to_json(*report::find(restored.answer, "result"));
}

/// Once for each step at which trouble of this kind can come.
void expect_truth_at_every_step(const Family& family, const RestoringOptions& how, int Trouble::*kind) {
  TrialWorld measure(family);
  ASSERT_TRUE(measure.put(how));
  const int steps = measure.frames;
  int partly = 0;
  for (int step = 0; step < steps; ++step) {
    SCOPED_TRACE(step);
    TrialWorld world(family);
    Trouble trouble;
    trouble.*kind = step;
    const auto done = world.put(how, trouble);
    if (!done) {
      EXPECT_TRUE(world.expect_no_trial_after_power_off()) << done.error().message.text();
      continue;
    }
    if (!done->failed) {
      EXPECT_EQ(world.values(), world.wanted);
      continue;
    }
    const bool is_kept = done->end == RestoreEnd::not_kept;
    if (!is_kept) {
      EXPECT_EQ(world.values(), world.before) << "it works with its trials again";
      EXPECT_EQ(world.means(), world.means_before);
    }
    const bool unchanged = world.expect_no_trial_after_power_off();
    const auto result = result_of(*done);
    if (unchanged || is_kept) continue;
    ++partly;
    EXPECT_EQ(result,
              "\"failed; it works with its old values, but its flash may not be as it was; see the errors\"");
    EXPECT_TRUE(world.is_told("its flash was not put back: after power-off these may have other values: "));
    EXPECT_EQ(report::to_json(*report::find(done->answer, "kept")), "null");
    ASSERT_TRUE(world.is_cut_off());
    RestoringOptions resume;
    resume.resume = true;
    const auto resumed = world.put(resume);
    ASSERT_TRUE(resumed) << resumed.error().message.text();
    EXPECT_FALSE(world.is_cut_off());
    world.power_cycle();
    EXPECT_EQ(world.values(), world.wanted);
  }
  EXPECT_GT(partly, 2);
}

TEST_P(FlashTrial, OfADriveThatRefusesAtAnyStepIsNotStored) {
  expect_truth_at_every_step(GetParam(), keep(), &Trouble::abort_at);
}

TEST_P(FlashTrial, IsNotStoredByCtrlCAtAnyStep) {
  expect_truth_at_every_step(GetParam(), keep(), &Trouble::cancel_at);
}

TEST_P(FlashTrial, GoesBackToTheRamByTheFileFromBefore) {
  TrialWorld measure(GetParam());
  ASSERT_TRUE(measure.run(measure.backup, "drive.json", measure.saved(), keep(), -1));
  int undone = 0;
  for (int step = 0; step < measure.frames; ++step) {
    SCOPED_TRACE(step);
    TrialWorld world(GetParam());
    ASSERT_FALSE(world.run(world.backup, "drive.json", world.saved(), keep(), step));
    if (!world.is_cut_off()) continue;
    ++undone;
    const auto back = read_backup(world.saved());
    ASSERT_TRUE(back) << back.error().message.text();
    ASSERT_TRUE(world.run(*back, "before", world.saved().string() + ".before-node-1.json", {}, -1,
                          journal_of(world.saved())));
    EXPECT_FALSE(world.is_cut_off());
    EXPECT_EQ(world.values(), world.before);
    EXPECT_EQ(world.means(), world.means_before);
    EXPECT_TRUE(world.is_told("so the old values go to its RAM; its flash may hold new ones"));
    (void)world.expect_no_trial_after_power_off();
  }
  EXPECT_GT(undone, 5);
}

TEST_P(FlashTrial, GoesToTheFlashByTheFileFromBeforeWhereThatIsAskedFor) {
  int step = 18;  // From there on the journal is written.
  auto cut_off = std::make_unique<TrialWorld>(GetParam());
  while (!cut_off->run(cut_off->backup, "drive.json", cut_off->saved(), keep(), step) &&
         !cut_off->is_cut_off()) {
    cut_off.reset();  // Its folder is that of the next.
    cut_off = std::make_unique<TrialWorld>(GetParam());
    ++step;
  }
  auto& world = *cut_off;
  ASSERT_TRUE(world.is_cut_off());
  const auto back = read_backup(world.saved());
  ASSERT_TRUE(back);
  ASSERT_TRUE(world.run(*back, "before", world.saved().string() + ".before-node-1.json", keep(), -1,
                        journal_of(world.saved())));
  EXPECT_FALSE(world.is_told("go to its RAM"));
  world.power_cycle();
  EXPECT_EQ(world.values(), world.before);
}

TEST_P(FlashTrial, NothingIsWrittenWhereTheSwitchIsAcknowledgedAndNotTaken) {
  TrialWorld world(GetParam());
  Trouble trouble;
  trouble.stuck = world.memory_switch();
  const auto done = world.put(keep(), trouble);
  const bool told = done ? world.is_told("did not take it: values would go to its RAM")
                         : done.error().message.text().find("did not take it") != std::string::npos;
  EXPECT_TRUE(told);
  EXPECT_TRUE(!done || done->failed);
  EXPECT_EQ(world.values(), world.before);
  world.power_cycle();
  EXPECT_EQ(world.values(), world.flash);
}

TEST_P(FlashTrial, OfADriveThatWorkedInItsFlashThereIsNone) {
  int back = 0;
  for (int step = 0; step < 40; ++step) {
    SCOPED_TRACE(step);
    World world(GetParam().settings);
    Trouble trouble;
    trouble.abort_at = step;
    const auto done = world.put(keep(), trouble);
    if (!done || done->end != RestoreEnd::rolled_back) continue;
    ++back;
    EXPECT_NE(report::to_json(*report::find(done->answer, "kept")), "true");
    EXPECT_FALSE(fs::exists(journal_of(world.saved())));
    world.power_cycle();
    EXPECT_EQ(world.values(), world.before);
  }
  EXPECT_GT(back, 2);
}

INSTANTIATE_TEST_SUITE_P(Families, FlashTrial, testing::Values(kTs, kSv2),
                         [](const auto& each) { return std::string(each.param.settings.family); });

}  // namespace
}  // namespace servoctl::settings
