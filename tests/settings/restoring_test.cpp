// A restore whose process is killed at any step can be gone on with, and can be undone.
#include "settings/restoring.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <filesystem>

#include "drive/quantity.hpp"
#include "session/can_network.hpp"
#include "settings/restore_journal.hpp"
#include "tests/session/troubled_bus.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using session::Killed;
using session::Trouble;
using session::TroubledBus;

struct Setting {
  const char* name;
  std::int64_t wanted;
};

struct Case {
  const char* family;
  std::vector<Setting> settings;
  bool unlock;
};

/// A drive, a backup that differs from it, and a folder for files.
class World {
 public:
  explicit World(const Case& c)
      : profile_(drive::load_profile(c.family, kFolders).value()), drive_(profile_, 1, memory_, "1") {
    fs::create_directories(folder_);
    bus_.attach(drive_);
    for (const auto& setting : c.settings) {
      const auto target = drive::resolve(&profile_, setting.name).value();
      objects_.push_back(target.address);
      Backup::Entry entry;
      entry.object = target.address;
      entry.type = drive::meaning(target, 1).type;
      entry.bytes = od::encode(entry.type, od::Value(setting.wanted)).value();
      backup.entries.push_back(entry);
    }
    for (const auto& mean : drive::means_of_writing(profile_)) means_.push_back(mean.first);
    backup.family = c.family;
    backup.identity.node = 1;
    before = read(objects_);
    means_before = read(means_);
  }
  ~World() { fs::remove_all(folder_); }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Runs one restore; true when it was not killed and had no error.
  bool run(const Backup& what, const std::string& title, const fs::path& saved, RestoringOptions options,
           int kill_at, const fs::path& undoes = {}) {
    Trouble trouble;
    trouble.kill_at = kill_at;
    auto bus = std::make_unique<TroubledBus>(bus_, drive_, trouble, 1);
    const auto* counted = bus.get();
    session::Session session(std::move(bus), "sim", {});
    show::Desk desk;
    desk.session = &session;
    desk.profile = &profile_;
    desk.nodes = {1};
    show::Willing willing;
    desk.audience = &willing;
    try {
      const auto done = put_into(desk, what, title, 1, saved, options, undoes);
      frames = counted->frames();
      EXPECT_TRUE(done) << done.error().message;
      for (const auto& error : desk.errors) ADD_FAILURE() << error.message;
      return done && desk.errors.empty();
    } catch (const Killed&) {
      return false;
    }
  }

  /// Runs one restore of the backup on a bus without trouble.
  Result<Restored> put(const RestoringOptions& options) {
    auto bus = std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1);
    session::Session session(std::move(bus), "sim", {});
    show::Desk desk;
    desk.session = &session;
    desk.profile = &profile_;
    show::Willing willing;
    desk.audience = &willing;
    return put_into(desk, backup, "drive.json", 1, saved(), options);
  }

  session::Values read(const std::vector<ObjectAddress>& objects) {
    session::Session session(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), "sim", {});
    (void)session.wait([] { return false; }, session.now() + 1s);
    session::Values out;
    for (const auto object : objects) out.emplace(object, session.upload(1, object).value());
    return out;
  }
  void power_cycle() {
    session::Session session(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), "sim", {});
    EXPECT_TRUE(session.can()->send(*can::parse_frame("000#8101")));
    (void)session.wait([] { return false; }, session.now() + 1s);
  }
  void expect_values_of_backup() {
    const auto now = read(objects_);
    for (const auto& entry : backup.entries) EXPECT_EQ(now.at(entry.object), *entry.bytes);
  }
  session::Values values() { return read(objects_); }
  session::Values means() { return read(means_); }
  fs::path saved() const { return folder_ / "drive.json.before-node-1.json"; }

  Backup backup;
  session::Values before;
  session::Values means_before;
  int frames = 0;

 private:
  static const std::vector<fs::path> kFolders;

  fs::path folder_ = fs::temp_directory_path() / fmt::format("servoctl-restoring-{}", ::getpid());
  drive::Profile profile_;
  sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  sim::Memory memory_;
  sim::SimDrive drive_;
  std::vector<ObjectAddress> objects_;
  std::vector<ObjectAddress> means_;
};

const std::vector<fs::path> World::kFolders = {fs::path(source_dir()) / "eds"};

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
    ASSERT_TRUE(back) << back.error().message;
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
  EXPECT_NE(refused.error().message.find("has changed since the plan was made"), std::string::npos);
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
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_FALSE(done->failed);
  world.expect_values_of_backup();
}

INSTANTIATE_TEST_SUITE_P(
    Families, KilledRestore,
    testing::Values(Case{"gsd600", {{"Pn0214", 450}, {"Pn0202", 321}, {"605Ah", 1}, {"6065h", 65536}}, false},
                    Case{"ts", {{"Fn_33", 120}, {"Fn_3A", 3}, {"Fn_12E", 50}}, true},
                    Case{"sv2", {{"2001h:1", 60}, {"2001h:2", 90}}, false}),
    [](const auto& each) { return std::string(each.param.family); });

}  // namespace
}  // namespace servoctl::settings
