// What `units learn` finds is kept for one drive, used by the motions of that drive alone, and dropped.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>
#include <csignal>
#include <fstream>

#include "base/file.hpp"
#include "command/command.hpp"
#include "command/registry.hpp"
#include "motion/kept_turn.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_drive.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class OwnBus final : public can::Bus {
 public:
  explicit OwnBus(sim::SimBus& bus) : bus_(&bus) {}
  TimePoint now() const override { return bus_->now(); }
  Result<void> send(const can::Frame& frame) override { return bus_->send(frame); }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override { return bus_->receive(deadline); }
  TimePoint next_event() const override { return bus_->next_event(); }

 private:
  sim::SimBus* bus_;
};

class Units : public testing::Test {
 protected:
  Units() {
    fs::create_directories(folder);
    start();
  }
  ~Units() override { fs::remove_all(folder); }

  /// The drive is switched on: the same one, or another with what `cells` hold.
  void start(std::unordered_map<ObjectAddress, Bytes> cells = {}) {
    memory_ = sim::Memory();
    for (auto& [object, bytes] : cells) memory_.cells("1")[object] = bytes;
    drive = std::make_unique<sim::SimDrive>(profile_, 1, memory_, "1");
    drive->own_counts() = 8388608;
    bus_ = std::make_unique<sim::SimBus>(sim::SimBus::Clock::virtual_time);
    bus_->attach(*drive);
    session_ =
        std::make_unique<session::Session>(std::make_unique<OwnBus>(*bus_), "can0", session::Options{});
    (void)session_->wait([] { return false; }, session_->now() + 1s);
  }

  /// Runs a command line of words; options are `--name value`, flags `--name ""`.
  Result<report::Value> run(std::string_view command,
                            std::initializer_list<std::pair<std::string_view, std::string>> words = {}) {
    Arguments arguments;
    for (const auto& [name, value] : words) arguments.add(name, value);
    Context context;
    context.session = session_.get();
    context.profile = &profile_;
    context.nodes = {1};
    context.state_folder = folder;
    context.dry_run = dry_run;
    show::Willing willing;
    context.audience = &willing;
    auto done = find_command(command)->run(context, arguments);
    notices.clear();
    for (const auto& notice : context.notices) append(notices, notice.text(), "\n");
    error = !done                    ? done.error().message.text()
            : context.errors.empty() ? ""
                                     : context.errors.front().message.text();
    return done;
  }
  bool learn() {
    const auto done = run("units learn");
    return done && error.empty();
  }
  bool jog(std::initializer_list<std::pair<std::string_view, std::string>> more = {}) {
    const auto done = more.size() == 0 ? run("jog", {{"speed", "60rpm"}, {"--for", "1s"}})
                                       : run("jog", {{"speed", "60rpm"}, {"--for", "1s"}, *more.begin()});
    return done && error.empty();
  }
  fs::path file() const {
    for (const auto& entry : fs::directory_iterator(folder)) return entry.path();
    return {};
  }
  /// Of the first row of a table.
  std::string cell(const Result<report::Value>& value, std::string_view key) const {
    const auto* table = value ? value->table() : nullptr;
    if (table == nullptr) return "no table";
    for (std::size_t i = 0; i < table->columns.size(); ++i)
      if (table->columns[i].key == key) return report::to_json(table->rows.front()[i]);
    return "no column";
  }

  bool dry_run = false;
  fs::path folder = fs::temp_directory_path() / fmt::format("servoctl-units-{}", ::getpid());
  std::unique_ptr<sim::SimDrive> drive;
  std::string notices;
  std::string error;

 private:
  static inline const fs::path kFolders[] = {fs::path(source_dir()) / "eds"};
  drive::Profile profile_ = drive::load_profile("gsd600", kFolders).value();
  sim::Memory memory_;
  std::unique_ptr<sim::SimBus> bus_;
  std::unique_ptr<session::Session> session_;
};

TEST_F(Units, AreUsedByTheMotionsOfTheDriveThatWasMeasured) {
  EXPECT_FALSE(jog()) << "nobody knows what 60rpm is";
  ASSERT_TRUE(learn()) << error;
  ASSERT_TRUE(jog()) << error;
  EXPECT_NE(notices.find("from the 8388608 encoder counts (2^23"), std::string::npos) << notices;
  EXPECT_NE(notices.find("the drive has no serial number"), std::string::npos) << notices;
  EXPECT_EQ(cell(run("units show"), "source"), "\"kept\"");
  ASSERT_TRUE(run("units forget"));
  EXPECT_TRUE(file().empty());
  EXPECT_FALSE(jog());
  EXPECT_EQ(cell(run("units show"), "value"), "null");
}

TEST_F(Units, GiveWayToWhatIsSaidAndToWhatTheDriveTells) {
  ASSERT_TRUE(learn()) << error;
  ASSERT_TRUE(jog({{"--turn", "8388608"}})) << error;
  EXPECT_EQ(notices.find("kept"), std::string::npos) << notices;
  EXPECT_EQ(cell(run("units show", {{"--turn", "5"}}), "source"), "\"--turn\"");
  start({{{0x2002, 0x39}, store_le(1, 2)}});  // Pn0456 = 1: Pn0458 counts.
  EXPECT_EQ(cell(run("units show"), "source"), "\"drive\"");
  EXPECT_EQ(cell(run("units show"), "value"), "131072");
  EXPECT_EQ(cell(run("units show"), "from"),
            "\"the drive: 0x2002:3Bh × 0x6091:2 / (0x6091:1) (when 0x2002:39h = 1, 0x2002:3Fh = 1, "
            "0x2002:41h = 1)\"");
  ASSERT_TRUE(jog()) << error;
  EXPECT_EQ(notices.find("kept"), std::string::npos) << notices;
  EXPECT_NE(
      notices.find(
          "131072 increments of 6064h per revolution, from the drive's parameters; Pn0458, Pn0456, Pn0462, "
          "Pn0464 take effect at a restart of the drive"),
      std::string::npos)
      << notices;
  ASSERT_TRUE(jog({{"--turn", "131072"}})) << error;
  EXPECT_EQ(notices.find("restarted"), std::string::npos) << notices;
  EXPECT_FALSE(learn());
  EXPECT_NE(error.find("its parameters already give 131072 increments per revolution once they take effect"),
            std::string::npos)
      << error;
}

TEST_F(Units, AreNotUsedForAGearThatNobodyKnows) {
  ASSERT_TRUE(learn()) << error;
  start({{{0x2002, 0x3F}, store_le(3, 4)}});  // Pn0462
  EXPECT_FALSE(jog());
  EXPECT_FALSE(learn());
  EXPECT_NE(error.find("Pn0462 is 3, not 1"), std::string::npos) << error;
}

TEST_F(Units, AreNotUsedForAnotherDrive) {
  ASSERT_TRUE(learn()) << error;
  start({{{0x1018, 4}, Bytes{0x63, 0, 0, 0}}});
  EXPECT_FALSE(jog());
  EXPECT_NE(notices.find("are not used: its serial number (1018h:04) is not the one"), std::string::npos)
      << notices;
  ASSERT_TRUE(run("units show"));
  EXPECT_NE(notices.find("its serial number (1018h:04)"), std::string::npos) << notices;
  ASSERT_TRUE(learn()) << error;
  ASSERT_TRUE(jog()) << error;
  EXPECT_EQ(notices.find("serial number"), std::string::npos) << notices;
}

TEST_F(Units, AreNotUsedFromAFileThatIsDamaged) {
  ASSERT_TRUE(learn()) << error;
  const auto whole = read_file(file()).value();
  const auto spoil = [&](const std::string& text) {
    std::ofstream(file(), std::ios::trunc) << text;
    EXPECT_FALSE(jog());
    EXPECT_NE(notices.find("are not used"), std::string::npos) << notices;
  };
  for (std::size_t size = 0; size + 1 < whole.size(); size += 7) spoil(whole.substr(0, size));
  auto edited = whole;
  spoil(edited.replace(edited.find("\"counts\":8388608"), 16, "\"counts\":4194304"));
  spoil("[1,2]");
  spoil(R"({"servoctl_turn":1,"node":1,"counts":-1})");
  std::ofstream(file(), std::ios::trunc) << whole;
  EXPECT_TRUE(jog()) << error;
}

TEST_F(Units, KeepNothingInADryRunNorWhenTheMeasurementFails) {
  dry_run = true;
  ASSERT_TRUE(run("units learn")) << error;
  EXPECT_TRUE(file().empty());
  dry_run = false;
  EXPECT_FALSE(run("units learn", {{"--nameplate", "131072"}}) && error.empty());
  EXPECT_NE(error.find("not the 131072 of --nameplate"), std::string::npos) << error;
  EXPECT_TRUE(file().empty());
  ASSERT_TRUE(learn()) << error;
  dry_run = true;
  ASSERT_TRUE(run("units forget"));
  EXPECT_FALSE(file().empty());
}

TEST_F(Units, TellWhenTheyCannotBeKept) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &none), 0);
  const auto done = run("units learn");
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  (void)std::signal(SIGXFSZ, old);
  EXPECT_NE(error.find("the measured 8388608 counts are not kept"), std::string::npos) << error;
  EXPECT_TRUE(file().empty()) << "nothing is left behind";
  EXPECT_FALSE(drive::is_energised(drive->power_state()));
}

TEST_F(Units, AreRefusedWithoutAFolderBeforeAnythingMoves) {
  fs::remove_all(folder);
  std::ofstream(folder) << "no folder";
  EXPECT_FALSE(learn());
  EXPECT_FALSE(drive->is_moving());
  folder.clear();
  EXPECT_FALSE(learn());
  EXPECT_NE(error.find("no folder to keep"), std::string::npos) << error;
}

}  // namespace
}  // namespace servoctl::commands
