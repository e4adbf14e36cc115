#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drive/quantity.hpp"
#include "session/can_network.hpp"
#include "settings/restore_journal.hpp"
#include "settings/restoring.hpp"
#include "tests/session/troubled_bus.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::settings {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using session::Killed;
using session::Trouble;
using session::TroubledBus;

/// A parameter and a value.
struct Setting {
  const char* name;
  std::int64_t value;
};

/// Settings of a family that a backup has.
struct Case {
  const char* family;
  std::vector<Setting> settings;
  bool unlock;
};

/// Says yes to everything, and remembers what it was asked.
class Asked final : public show::Audience {
 public:
  explicit Asked(std::vector<std::string>& questions) : questions_(&questions) {}
  Result<void> confirm(std::string_view question) override {
    questions_->emplace_back(question);
    return {};
  }

 private:
  std::vector<std::string>* questions_;
};

/// A drive, a backup that differs from it, and a folder for files, which all that live at a time have in
/// common.
class World {
 public:
  explicit World(const Case& c, std::optional<std::uint32_t> serial = {}, std::string url = "sim")
      : profile_(load(c.family)), url_(std::move(url)), drive_(profile_, 1, memory_, "1") {
    fs::create_directories(folder_);
    if (serial) drive_.enable_lss(*serial);
    bus_.attach(drive_);
    for (const auto& setting : c.settings) {
      const auto target = drive::resolve(&profile_, setting.name).value();
      objects_.push_back(target.address);
      Backup::Entry entry;
      entry.object = target.address;
      entry.type = drive::meaning(target, 1).type;
      entry.bytes = od::encode(entry.type, od::Value(setting.value)).value();
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
    session::Session session(std::move(bus), url_, {});
    show::Desk desk;
    desk.session = &session;
    desk.profile = &profile_;
    desk.chinese = chinese;
    desk.nodes = {1};
    show::Willing willing;
    desk.audience = &willing;
    try {
      const auto done = put_into(desk, what, title, 1, saved, options, undoes);
      frames = counted->frames();
      EXPECT_TRUE(done) << done.error().message.text();
      for (const auto& error : desk.errors) ADD_FAILURE() << error.message.text();
      notices = desk.notices;
      return done && desk.errors.empty();
    } catch (const Killed&) {
      return false;
    }
  }

  /// Runs one restore of the backup, and counts its frames.
  Result<Restored> put(const RestoringOptions& options, const Trouble& trouble = {}) {
    return put(backup, "drive.json", saved(), options, {}, trouble);
  }
  Result<Restored> put(const Backup& what, const std::string& title, const fs::path& saved_in,
                       const RestoringOptions& options, const fs::path& undoes = {},
                       const Trouble& trouble = {}) {
    auto bus = std::make_unique<TroubledBus>(bus_, drive_, trouble, 1);
    const auto* counted = bus.get();
    session::Session session(std::move(bus), url_, {});
    session.options().cancelled = [&] {
      return trouble.cancel_at >= 0 && counted->frames() > trouble.cancel_at;
    };
    show::Desk desk;
    desk.session = &session;
    desk.profile = &profile_;
    desk.chinese = chinese;
    Asked asked(questions);
    desk.audience = &asked;
    auto done = put_into(desk, what, title, 1, saved_in, options, undoes);
    notices = desk.notices;
    errors = desk.errors;
    frames = counted->frames();
    return done;
  }

  session::Values read(const std::vector<ObjectAddress>& objects) {
    session::Session session(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), url_, {});
    (void)session.wait([] { return false; }, session.now() + 1s);
    session::Values out;
    for (const auto object : objects) out.emplace(object, session.upload(1, object).value());
    return out;
  }
  void write(const std::vector<Setting>& settings) {
    session::Session session(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), url_, {});
    for (const auto& setting : settings) {
      const auto target = drive::resolve(&profile_, setting.name).value();
      const auto type = drive::meaning(target, 1).type;
      EXPECT_TRUE(session.download(1, target.address, od::encode(type, od::Value(setting.value)).value()));
    }
  }
  void power_cycle() {
    session::Session session(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), url_, {});
    EXPECT_TRUE(session.can()->send(*can::parse_frame("000#8101")));
    (void)session.wait([] { return false; }, session.now() + 1s);
  }
  void expect_values_of_backup() {
    const auto now = read(objects_);
    for (const auto& entry : backup.entries) EXPECT_EQ(now.at(entry.object), *entry.bytes);
  }
  /// From now on it is reached by this URL, as far as anybody can tell.
  void connect(std::string url) { url_ = std::move(url); }
  const drive::Profile& profile() const { return profile_; }
  session::Values values() { return read(objects_); }
  session::Values means() { return read(means_); }
  fs::path saved() const { return folder_ / "drive.json.before-node-1.json"; }

  Backup backup;
  session::Values before;
  session::Values means_before;
  std::vector<std::string> questions;
  std::vector<Message> notices;
  std::vector<Error> errors;
  bool chinese = false;
  int frames = 0;

 private:
  static drive::Profile load(const char* family) {
    const fs::path folders[] = {fs::path(source_dir()) / "eds"};
    return drive::load_profile(family, folders).value();
  }

  fs::path folder_ = fs::temp_directory_path() / fmt::format("servoctl-restoring-{}", ::getpid());
  drive::Profile profile_;
  std::string url_;
  sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  sim::Memory memory_;
  sim::SimDrive drive_;
  std::vector<ObjectAddress> objects_;
  std::vector<ObjectAddress> means_;
};

}  // namespace servoctl::settings
