#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <map>

#include "cli/batch/batch.hpp"
#include "cli/batch/setting_lines.hpp"
#include "cli/line_runner.hpp"
#include "cli/parse.hpp"
#include "cli/shell.hpp"
#include "cli/words.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "recording_console.hpp"
#include "settings/backup_formats.hpp"
#include "settings/comparison.hpp"
#include "settings/restoring.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_drive.hpp"
#include "tests/session/troubled_bus.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {

namespace fs = std::filesystem;
using session::Trouble;
using session::TroubledBus;
using settings::Backup;
using settings::BackupFormat;
using namespace std::chrono_literals;

inline const std::vector<fs::path>& folders() {
  static const std::vector<fs::path> all{fs::path(source_dir()) / "eds",
                                         fs::path(source_dir()) / "tests/cli/data/drives"};
  return all;
}

inline const drive::Profile& profile_of(const std::string& family) {
  static std::map<std::string, drive::Profile> all;
  const auto found = all.find(family);
  return found != all.end()
             ? found->second
             : all.emplace(family, drive::load_profile(family, folders()).value()).first->second;
}

/// One drive that holds what a test put into its memory.
class World : public settings::LineReader {
 public:
  World(const std::string& family, const sim::Memory::Cells& cells)
      : profile_(&profile_of(family)),
        drive_((memory_.cells("1") = cells, profile_of(family)), 1, memory_, "1") {
    fs::create_directories(folder_);
    bus_.attach(drive_);
    (void)session().wait([] { return false; }, session().now() + 1s);
    context.session = &session();
    context.profile = profile_;
    context.nodes = {1};
    context.audience = &willing_;
  }
  ~World() override { fs::remove_all(folder_); }

  Result<std::vector<settings::SettingLine>> setting_lines(std::string_view text,
                                                           const std::string& file) override {
    return cli::setting_lines(shell(), text, file);
  }

  Backup backup() {
    const std::uint8_t nodes[] = {1};
    return settings::make_backup(context,
                                 session::take_snapshots(session(), *profile_, nodes, {}).front().value());
  }
  Result<std::string> text(const Backup& backup, BackupFormat format) {
    return settings::backup_text(context, backup, format, "drive");
  }
  Result<Backup> read(std::string text, BackupFormat format) {
    return settings::read_backup(context, {"drive", std::move(text), format, this}, profile_, 1);
  }
  Result<settings::Restored> restore(const Backup& backup) {
    context.errors.clear();
    // A password that the bus cannot give is told, and nothing written.
    const auto& store = profile_->rules.store;
    const auto* password = profile_->parameter(store.unlock);
    settings::RestoringOptions how;
    how.unlock = password != nullptr && password->object && store.unlock_open;
    // Each restore for itself: one that could not be undone would keep the next from its start.
    fs::remove(journal_);
    return settings::put_into(context, backup, "drive", 1, folder_ / "before.json", how);
  }
  /// What a drive that is set holds and one that a backup is put into holds differ in these.
  std::map<ObjectAddress, Bytes> values(const Backup& of) {
    std::map<ObjectAddress, Bytes> out;
    for (const auto& entry : of.entries) out.emplace(entry.object, drive_.value(entry.object));
    return out;
  }
  session::Session& session() {
    if (!session_)
      session_ = std::make_unique<session::Session>(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1),
                                                    "sim:1", session::Options{});
    return *session_;
  }
  sim::SimDrive& drive() { return drive_; }
  bool is_cut_off() const { return fs::exists(journal_); }

  command::Context context;

 private:
  Shell& shell() {
    if (!shell_) {
      Shell::Options options;
      options.drive_folders = folders();
      shell_ = std::make_unique<Shell>(console_, std::move(options));
    }
    return *shell_;
  }

  fs::path folder_ = fs::temp_directory_path() / fmt::format("servoctl-property-{}", ::getpid());
  fs::path journal_ = folder_ / "before.json.journal";
  const drive::Profile* profile_;
  sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  sim::Memory memory_;
  sim::SimDrive drive_;
  std::unique_ptr<session::Session> session_;
  RecordingConsole console_;
  std::unique_ptr<Shell> shell_;
  show::Willing willing_;
};

}  // namespace servoctl::cli
