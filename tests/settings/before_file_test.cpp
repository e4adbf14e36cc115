// Whose old values and journal a restore takes up: those of the drive that is there, never another one's.
#include <fcntl.h>
#include <sys/file.h>
#include <algorithm>

#include "base/file.hpp"
#include "restoring_world.hpp"

namespace servoctl::settings {
namespace {

const Case kCase{"gsd600", {{"Pn0214", 450}, {"Pn0202", 321}, {"605Ah", 1}, {"6065h", 65536}}, false};

RestoringOptions resume() {
  RestoringOptions out;
  out.resume = true;
  return out;
}

RestoringOptions forced() {
  RestoringOptions out;
  out.choice.force = true;
  return out;
}

std::string text(const fs::path& file) { return read_file(file).value_or("(none)"); }

bool has_notice(const World& world, const std::string& part) {
  return std::any_of(world.notices.begin(), world.notices.end(),
                     [&](const auto& notice) { return notice.text().find(part) != std::string::npos; });
}

/// A restore into this drive is killed in the middle of its writes; its old values are in `before`.
void cut_off(World& world, const fs::path& before) {
  for (int step = 0; step < 500; ++step) {
    ASSERT_FALSE(world.run(world.backup, "drive.json", world.saved(), {}, step));
    if (fs::exists(journal_of(before)) && world.values() != world.before) return;
    fs::remove(journal_of(before));
  }
  FAIL() << "no step is between two writes";
}
void cut_off(World& world) { cut_off(world, world.saved()); }

Result<Restored> undo(World& world, const RestoringOptions& options) {
  const auto saved = world.saved();
  const auto old = read_backup(saved);
  if (!old) return fail(old.error());
  return world.put(*old, "drive.json.before-node-1.json", saved.string() + ".before-node-1.json", options,
                   journal_of(saved));
}

fs::path second(const World& world) {
  return world.saved().parent_path() / "drive.json.before-node-1-drive-2.json";
}

TEST(OldValues, OfADriveThatWasExchangedAreNotTakenUpByTheNewOne) {
  World old(kCase, 1);
  cut_off(old);
  const auto kept = text(old.saved());
  const auto journal = text(journal_of(old.saved()));
  World fresh(kCase, 2);
  const auto refused = fresh.put(resume());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_NE(refused.error().message.text().find("was of another drive: its serial number (1018h:04) differs"),
            std::string::npos)
      << refused.error().message.text();
  EXPECT_NE(refused.error().hint.text().find("leave --resume out"), std::string::npos)
      << refused.error().hint.text();
  EXPECT_EQ(fresh.values(), fresh.before);
  // Begun anew as the hint says, with a file of its own.
  const auto done = fresh.put({});
  ASSERT_TRUE(done) << done.error().message.text();
  fresh.expect_values_of_backup();
  EXPECT_TRUE(has_notice(fresh, "the old values of node 1 are in " + second(fresh).string()));
  EXPECT_TRUE(has_notice(fresh, "is left as it is, its serial number (1018h:04) differs"));
  EXPECT_EQ(text(old.saved()), kept);
  EXPECT_EQ(text(journal_of(old.saved())), journal);
  EXPECT_FALSE(fs::exists(journal_of(second(fresh))));
  // The old one, mended: its own restore goes on.
  const auto resumed = old.put(resume());
  ASSERT_TRUE(resumed) << resumed.error().message.text();
  old.expect_values_of_backup();
  EXPECT_TRUE(has_notice(old, "the old values of node 1 are in " + old.saved().string()));
  EXPECT_EQ(text(old.saved()), kept);
}

TEST(OldValues, OfAnotherDriveAreNotWhatAnUndoWrites) {
  World old(kCase, 1);
  const auto before = old.before;
  cut_off(old);
  const auto journal = text(journal_of(old.saved()));
  World fresh(kCase, 2);
  ASSERT_TRUE(fresh.put({}));
  const auto wanted = fresh.values();
  const auto refused = undo(fresh, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::refused);
  EXPECT_NE(refused.error().message.text().find(
                "old values of another drive, whose restore was interrupted: its serial"),
            std::string::npos)
      << refused.error().message.text();
  EXPECT_EQ(fresh.values(), wanted);
  // Whoever wants them all the same gets them as those of a backup; the journal is not of this drive.
  const auto done = undo(fresh, forced());
  ASSERT_TRUE(done) << done.error().message.text();
  EXPECT_EQ(fresh.values(), before);
  EXPECT_EQ(text(journal_of(old.saved())), journal);
  ASSERT_TRUE(undo(old, {}));
  EXPECT_EQ(old.values(), before);
  EXPECT_FALSE(fs::exists(journal_of(old.saved())));
}

TEST(OldValues, OfADriveWithASerialNumberAreItsOwnBehindAnotherAdapterToo) {
  for (const bool goes_on : {true, false}) {
    World old(kCase, 7);
    const auto before = old.before;
    cut_off(old);
    old.connect("slcan:/dev/ttyACM1@1M");
    const auto done = goes_on ? old.put(resume()) : undo(old, {});
    ASSERT_TRUE(done) << done.error().message.text();
    if (goes_on) old.expect_values_of_backup();
    if (!goes_on) {
      EXPECT_EQ(old.values(), before);
    }
    EXPECT_FALSE(fs::exists(journal_of(old.saved())));
  }
}

TEST(OldValues, OfADriveWithoutASerialNumberAreInDoubtOnAnotherBus) {
  World old(kCase);
  const auto before = old.before;
  cut_off(old);
  const auto kept = text(old.saved());
  const auto between = old.values();
  old.connect("can1");
  for (const auto& how : {RestoringOptions{}, resume()}) {
    const auto refused = old.put(how);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::refused);
    EXPECT_NE(refused.error().message.text().find(
                  "interrupted on sim, and nothing tells whether this is that drive"),
              std::string::npos)
        << refused.error().message.text();
  }
  const auto refused = undo(old, {});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.text().find("the old values of the drive on sim, and nothing tells"),
            std::string::npos)
      << refused.error().message.text();
  EXPECT_EQ(old.values(), between);
  EXPECT_EQ(text(old.saved()), kept);
  // Who knows that it is that drive says so.
  ASSERT_TRUE(undo(old, forced()));
  EXPECT_EQ(old.values(), before);
  EXPECT_EQ(old.means(), old.means_before);
  EXPECT_FALSE(fs::exists(journal_of(old.saved())));
}

TEST(OldValues, OfTheDriveOnOneBusAreNotReplacedByThoseOfAnotherBus) {
  World first(kCase);
  ASSERT_TRUE(first.put({}));
  const auto kept = text(first.saved());
  World other(kCase, {}, "can1");
  ASSERT_TRUE(other.put({}));
  EXPECT_EQ(text(first.saved()), kept);
  EXPECT_TRUE(
      has_notice(other, "is left as it is, it is of the drive on sim: the old values of node 1 go to"));
  EXPECT_TRUE(has_notice(other, "the old values of node 1 are in " + second(other).string()));
  EXPECT_NE(text(second(other)).find("\"bus\":\"can1\""), std::string::npos);
  // Each finds its own again.
  ASSERT_TRUE(undo(first, {}));
  EXPECT_EQ(first.values(), first.before);
  ASSERT_TRUE(first.put({}));
  ASSERT_TRUE(other.put({}));
  EXPECT_FALSE(fs::exists(first.saved().parent_path() / "drive.json.before-node-1-drive-3.json"));
  // And goes on with its own, though the one before it is gone.
  World cut(kCase, {}, "can1");
  fs::remove(second(cut));
  cut_off(cut, second(cut));
  fs::remove(first.saved());
  const auto anew = cut.put({});
  ASSERT_FALSE(anew);
  EXPECT_NE(anew.error().message.text().find("was interrupted"), std::string::npos)
      << anew.error().message.text();
  ASSERT_TRUE(cut.put(resume()));
  cut.expect_values_of_backup();
  EXPECT_FALSE(fs::exists(journal_of(second(cut))));
}

/// As another servoctl holds it.
class Held {
 public:
  Held(const fs::path& before, std::string_view bus)
      : fd_(::open((journal_of(before).string() + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    EXPECT_EQ(::flock(fd_, LOCK_EX | LOCK_NB), 0);
    EXPECT_EQ(::ftruncate(fd_, 0), 0);
    EXPECT_EQ(::write(fd_, bus.data(), bus.size()), static_cast<ssize_t>(bus.size()));
  }
  ~Held() { ::close(fd_); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

 private:
  int fd_;
};

TEST(OldValues, AreNotedForOneBusWhileARestoreRunsOnAnother) {
  World world(kCase);
  {
    const Held same(world.saved(), "sim");
    const auto refused = world.put({});
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.text().find("another servoctl is restoring"), std::string::npos);
    EXPECT_EQ(world.values(), world.before);
  }
  {
    // It has noted nothing yet.
    const Held other(world.saved(), "can1");
    ASSERT_TRUE(world.put({}));
    world.expect_values_of_backup();
    EXPECT_FALSE(fs::exists(world.saved()));
    EXPECT_TRUE(fs::exists(second(world)));
  }
  World next(kCase, {}, "can1");
  cut_off(next);
  {
    // It has begun to write.
    const Held other(next.saved(), "can1");
    fs::remove(second(world));
    World third(kCase);
    const auto done = third.put({});
    ASSERT_TRUE(done) << done.error().message.text();
    EXPECT_TRUE(fs::exists(second(world)));
  }
}

TEST(OldValues, ThatCannotBeReadAreNotReplacedAndTheirJournalIsNotTakenUp) {
  World world(kCase);
  ASSERT_TRUE(write_file_atomically(world.saved(), "notes of somebody\n"));
  ASSERT_TRUE(world.put({}));
  EXPECT_EQ(text(world.saved()), "notes of somebody\n");
  EXPECT_TRUE(fs::exists(second(world)));
  World cut(kCase);
  fs::remove(world.saved());
  fs::remove(second(world));
  cut_off(cut);
  const auto between = cut.values();
  fs::remove(cut.saved());
  for (const auto& how : {RestoringOptions{}, resume()}) {
    const auto refused = cut.put(how);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::file);
    EXPECT_NE(refused.error().message.text().find("nothing tells of which drive"), std::string::npos)
        << refused.error().message.text();
  }
  EXPECT_EQ(cut.values(), between);
}

}  // namespace
}  // namespace servoctl::settings
