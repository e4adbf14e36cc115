// A backup that servoctl wrote is always one it takes: whatever a drive of any family holds.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <rapidcheck/gtest.h>
#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

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
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using session::Trouble;
using session::TroubledBus;
using settings::Backup;
using settings::BackupFormat;

const std::vector<fs::path>& folders() {
  static const std::vector<fs::path> all{fs::path(source_dir()) / "eds",
                                         fs::path(source_dir()) / "tests/cli/data/drives"};
  return all;
}

const drive::Profile& profile_of(const std::string& family) {
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

/// A value of the type, with no thought of limits.
Bytes any_value(od::DataType type, std::mt19937& random) {
  auto size = od::size_of(type).value_or(random() % 12);
  Bytes out(size);
  for (auto& byte : out) byte = static_cast<std::uint8_t>(random());
  if (type == od::DataType::boolean) out[0] &= 1U;
  return out;
}

/// Something in half of all settings; what addresses the drive and its PDOs' records stay those of the
/// factory now and then, so that the drive is one that can be spoken to.
sim::Memory::Cells any_drive(const drive::Profile& profile, std::mt19937& random) {
  sim::Memory::Cells out;
  for (const auto& setting : drive::settings_of(profile)) {
    if (!setting.left_out.empty() || random() % 2 == 0) continue;
    const auto object = setting.entry->address;
    if (settings::is_address(&profile, object)) continue;
    // How it answers at all: heartbeats and SYNC of any length would only fill the bus.
    if (object.index >= 0x1000 && object.index < 0x1400) continue;
    out[object] = any_value(setting.entry->type, random);
  }
  return out;
}

class Families : public testing::TestWithParam<std::string> {};

TEST_P(Families, TakeBackWhatTheyHeldFromEveryFormat) {
  std::mt19937 random(2026);
  for (int round = 0; round < 6; ++round) {
    const auto& profile = profile_of(GetParam());
    const auto cells = any_drive(profile, random);
    World world(GetParam(), cells);
    const auto backup = world.backup();
    const auto held = world.values(backup);
    for (const auto format :
         {BackupFormat::json, BackupFormat::csv, BackupFormat::dcf, BackupFormat::batch}) {
      SCOPED_TRACE(fmt::format("round {}, format {}", round, static_cast<int>(format)));
      const auto text = world.text(backup, format);
      if (!text) continue;  // A family without data sheet has no DCF.
      const auto read = world.read(*text, format);
      ASSERT_TRUE(read) << read.error().message;
      const auto same = world.restore(*read);
      ASSERT_TRUE(same) << same.error().message;
      EXPECT_TRUE(world.context.errors.empty()) << world.context.errors.front().message;
      EXPECT_EQ(world.values(backup), held) << "nothing differed";
    }
  }
}

TEST_P(Families, PutWhatIsWithinLimitsIntoAFactoryDriveAndNameTheRest) {
  std::mt19937 random(7);
  for (int round = 0; round < 4; ++round) {
    World source(GetParam(), any_drive(profile_of(GetParam()), random));
    const auto backup = source.backup();
    World target(GetParam(), {});
    const auto read = target.read(source.text(backup, BackupFormat::json).value(), BackupFormat::json);
    ASSERT_TRUE(read) << read.error().message;
    auto one = *read;
    // One after the other: a drive may refuse what it held itself, in this state or beside other values.
    std::size_t taken = 0;
    for (const auto& entry : read->entries) {
      if (!entry.bytes) continue;
      one.entries = {entry};
      const auto done = target.restore(one);
      ASSERT_TRUE(done) << done.error().message;
      const bool same = target.drive().value(entry.object) == *entry.bytes;
      const bool told = !target.context.errors.empty();
      EXPECT_TRUE(same || told || settings::is_address(&profile_of(GetParam()), entry.object))
          << to_string(entry.object) << " was not written, and nothing says so";
      EXPECT_TRUE(told || !target.is_cut_off()) << to_string(entry.object);
      taken += same ? 1U : 0U;
    }
    EXPECT_GT(taken, read->entries.size() / 4);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Families,
                         testing::Values("gsd600", "dm", "da200", "ts", "sv2", "cia402", "lab"),
                         [](const auto& each) { return each.param; });

TEST(ABackup, LeavesOutACobIdThatNoDriveMayHaveAndIsTaken) {
  World world("dm", {{{0x1801, 1}, store_le(0x601, 4)}});
  ASSERT_EQ(load_le(world.drive().value({0x1801, 1})), 0x601U);
  const auto backup = world.backup();
  settings::tell_left_out(world.context, backup);
  ASSERT_EQ(world.context.notices.size(), 1U);
  EXPECT_NE(world.context.notices[0].find("CAN-ID 0x601 belongs to SDO"), std::string::npos)
      << world.context.notices[0];
  const auto done =
      world.restore(world.read(world.text(backup, BackupFormat::json).value(), BackupFormat::json).value());
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_TRUE(world.context.errors.empty());
}

/// Text as it would hurt: each piece with a meaning to somebody who reads a line.
std::string any_text(std::mt19937& random) {
  static const std::vector<std::string> kPieces = {"--from=/etc/passwd",
                                                   "--yes",
                                                   "-h",
                                                   "--help",
                                                   "--",
                                                   "-",
                                                   "\"",
                                                   "'",
                                                   "\\",
                                                   "#",
                                                   "${A}",
                                                   "$",
                                                   "\n",
                                                   "\r",
                                                   "\n6040h 15",
                                                   " ",
                                                   "\t",
                                                   "=",
                                                   "=1+1",
                                                   "@",
                                                   "+",
                                                   "hex:00",
                                                   "\x1b[2J",
                                                   "\xC2\x9B",
                                                   "\xE2\x80\xAE",
                                                   "\xFF",
                                                   "\xE6\x8C\xAF",
                                                   "a",
                                                   "1",
                                                   "0x10",
                                                   ";",
                                                   "[1017]",
                                                   ",",
                                                   std::string(1, '\0'),
                                                   "end",
                                                   "use 2",
                                                   "\x7F"};
  std::string out;
  for (auto left = random() % 6; left > 0; --left) out += kPieces[random() % kPieces.size()];
  return out;
}

TEST(AnyText, SurvivesEveryFormatAndIsNothingButAValue) {
  std::mt19937 random(15);
  for (int round = 0; round < 600; ++round) {
    const auto text = any_text(random);
    SCOPED_TRACE(fmt::format("round {}: {}", round, to_hex(Bytes(text.begin(), text.end()))));
    const Bytes bytes(text.begin(), text.end());
    const ObjectAddress object{0x2000, 0};
    World source("lab", {{object, bytes}});
    ASSERT_EQ(source.drive().value(object), bytes);
    auto backup = source.backup();
    std::erase_if(backup.entries, [&](const auto& entry) { return entry.object != object; });
    World target("lab", {{object, Bytes{'o', 'l', 'd'}}});
    for (const auto format :
         {BackupFormat::json, BackupFormat::csv, BackupFormat::batch, BackupFormat::dcf}) {
      SCOPED_TRACE(static_cast<int>(format));
      const auto written = target.text(backup, format);
      ASSERT_TRUE(written) << written.error().message;
      const auto read = target.read(*written, format);
      if (format == BackupFormat::dcf && !read)
        continue;  // Nothing of it could stand there, and that is told.
      ASSERT_TRUE(read) << read.error().message << "\n" << *written;
      for (const auto& entry : read->entries) {
        ASSERT_TRUE(format == BackupFormat::dcf || entry.object == object) << to_string(entry.object);
        if (entry.object == object && entry.bytes) {
          ASSERT_EQ(*entry.bytes, bytes) << *written;
        }
      }
    }
    const auto read = target.read(target.text(backup, BackupFormat::json).value(), BackupFormat::json);
    const auto done = target.restore(read.value());
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_TRUE(target.context.errors.empty()) << target.context.errors.front().message;
    EXPECT_EQ(target.drive().value(object), bytes);
  }
}

RC_GTEST_PROP(AnyText, InALineIsOneValueOfOneWriteAndNoOption,
              (const std::string& before, std::uint32_t seed)) {
  std::mt19937 random(seed);
  const auto text = before + any_text(random);
  const Bytes bytes(text.begin(), text.end());
  const auto line = settings::commented_line(&profile_of("lab"), 1, {0x2000, 0}, bytes);
  const auto batch = parse_batch(line + "\nread 0x1000\n");
  RC_ASSERT(batch.errors.empty());
  RC_ASSERT(batch.statements.size() == 2U);
  const auto words = split_words(batch.statements.front().text).value();
  const auto first = parse_line(words).value();
  RC_ASSERT(first.command->path == "write");
  for (const auto* option : {"--from", "--keep", "--unlock", "--yes", "--trace", "--bus"})
    RC_ASSERT(!first.arguments.has(option));
  const auto target = drive::resolve(&profile_of("lab"), first.arguments.text("object")).value();
  RC_ASSERT(target.address == (ObjectAddress{0x2000, 0}));
  const auto meaning = drive::meaning(target, 1);
  const auto value = drive::parse_quantity(meaning, first.arguments.text("value")).value();
  RC_ASSERT(od::encode(meaning.type, value).value() == bytes);
}

}  // namespace
}  // namespace servoctl::cli
