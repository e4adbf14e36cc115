// A change of PDOs whose process is killed at any step leaves a record with which everything is as before.
#include "pdo/pdo_record.hpp"
#include "command/command.hpp"
#include "command/registry.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <fstream>
#include <span>

#include "drive/drive_settings.hpp"
#include "session/can_network.hpp"
#include "session/pdo_setup.hpp"
#include "session/wary.hpp"
#include "tests/session/troubled_bus.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::commands {
using namespace command;
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using session::Killed;
using session::Trouble;
using session::TroubledBus;

struct Case {
  const char* family;
  const char* pdo;
  std::vector<const char*> objects;
  bool keep = false;
  const char* cob_id = nullptr;
};

/// A drive, Operational, and a folder for state.
class World {
 public:
  explicit World(const Case& c)
      : case_(c),
        profile_(drive::load_profile(c.family, kFolders).value()),
        drive_(profile_, 1, memory_, "1") {
    bus_.attach(drive_);
    session::Session quiet(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), "can0", {});
    (void)quiet.wait([] { return false; }, quiet.now() + 1s);
    EXPECT_TRUE(quiet.can()->send(*can::parse_frame("000#0101")));
    before = read();
    means_before = means();
  }
  ~World() { fs::remove_all(folder_); }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Runs a command; true when it was not killed and had no error.
  bool run(std::string_view command, const Arguments& arguments, const Trouble& trouble = {}) {
    auto bus = std::make_unique<TroubledBus>(bus_, drive_, trouble, 1);
    const auto* counted = bus.get();
    session::Options network;
    network.drive_folders = [] { return std::span<const fs::path>(kFolders); };
    session::Session session(std::move(bus), url, std::move(network));
    session::be_wary_of_family(session, 1, profile_);  // As the program does before each command.
    Context context;
    context.session = &session;
    context.profile = &profile_;
    context.nodes = {1};
    context.state_folder = folder_;
    show::Willing willing;
    context.audience = &willing;
    notices.clear();
    try {
      const auto done = find_command(command)->run(context, arguments);
      frames = counted->frames();
      for (const auto& notice : context.notices) notices += notice.text() + "\n";
      error = !done                    ? done.error().message.text()
              : context.errors.empty() ? ""
                                       : context.errors.front().message.text();
      return done && context.errors.empty();
    } catch (const Killed&) {
      return false;
    }
  }
  bool map(const Trouble& trouble = {}) {
    Arguments arguments;
    arguments.add("pdo", case_.pdo);
    for (const auto* object : case_.objects) arguments.add("object", object);
    if (case_.keep) arguments.add("--keep", "");
    if (case_.cob_id != nullptr) arguments.add("--cob-id", case_.cob_id);
    return run("pdo map", arguments, trouble);
  }
  bool put_back() {
    Arguments arguments;
    arguments.add("file", record().string());
    return run("pdo apply", arguments);
  }
  /// The drive at the node is exchanged for one of another serial number.
  void become_another() {
    memory_.cells("1") = {{ObjectAddress{0x1018, 4}, Bytes{0x63, 0, 0, 0}}};
    power_cycle();
  }
  int records() const {
    int out = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) out += entry.path().extension() == ".json";
    return out;
  }
  bool has_record() const { return !fs::is_empty(folder_); }
  fs::path folder() const { return folder_; }
  fs::path record() const {
    for (const auto& entry : fs::directory_iterator(folder_))
      if (entry.path().extension() == ".json") return entry.path();
    return {};
  }

  session::Values read() {
    session::Session quiet(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), "can0", {});
    const std::uint8_t nodes[] = {1};
    return session::read_pdo_values(quiet, &profile_, nodes).front().value();
  }
  session::Values means() {
    session::Session quiet(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), "can0", {});
    session::Values out;
    for (const auto& mean : drive::means_of_writing(profile_))
      if (auto value = quiet.upload(1, mean.first)) out.emplace(mean.first, *value);
    return out;
  }
  void power_cycle() {
    session::Session quiet(std::make_unique<TroubledBus>(bus_, drive_, Trouble{}, 1), "can0", {});
    EXPECT_TRUE(quiet.can()->send(*can::parse_frame("000#8101")));
    (void)quiet.wait([] { return false; }, quiet.now() + 1s);
  }

  /// The bus as the next lines name it.
  std::string url = "can0";

  session::Values before;
  session::Values means_before;
  std::string notices;
  std::string error;
  int frames = 0;

 private:
  static fs::path made_folder() {
    auto out = fs::temp_directory_path() / fmt::format("servoctl-pdo-record-{}", ::getpid());
    fs::create_directories(out);
    return out;
  }
  static const std::vector<fs::path> kFolders;

  Case case_;
  fs::path folder_ = made_folder();
  drive::Profile profile_;
  sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  sim::Memory memory_;
  sim::SimDrive drive_;
};

const std::vector<fs::path> World::kFolders = {fs::path(source_dir()) / "eds"};

class KilledChange : public testing::TestWithParam<Case> {};

TEST_P(KilledChange, IsPutBackFromAnyStepByItsRecord) {
  World measure(GetParam());
  ASSERT_TRUE(measure.map()) << measure.error;
  EXPECT_FALSE(measure.has_record());
  EXPECT_NE(measure.read(), measure.before);
  int cut_off = 0;
  for (int step = 0; step < measure.frames; ++step) {
    SCOPED_TRACE(step);
    World world(GetParam());
    Trouble trouble;
    trouble.kill_at = step;
    ASSERT_FALSE(world.map(trouble));
    if (!world.has_record()) {
      EXPECT_EQ(world.read(), world.before) << "written without a record";
      continue;
    }
    ++cut_off;
    ASSERT_TRUE(world.run("pdo show", {}));
    EXPECT_NE(world.notices.find("pdo apply " + world.record().string()), std::string::npos) << world.notices;
    ASSERT_TRUE(world.put_back()) << world.error;
    EXPECT_FALSE(world.has_record());
    EXPECT_EQ(world.notices.find("was interrupted"), std::string::npos);
    EXPECT_EQ(world.read(), world.before);
    EXPECT_EQ(world.means(), world.means_before);
    if (!GetParam().keep) continue;
    world.power_cycle();
    EXPECT_EQ(world.read(), world.before);
  }
  EXPECT_GT(cut_off, 5);
}

INSTANTIATE_TEST_SUITE_P(Families, KilledChange,
                         testing::Values(Case{"gsd600", "TPDO1", {"0x6064", "0x6041"}, true},
                                         Case{"dm", "TPDO3", {"0x6064", "0x6041"}, false, "0x3A5"},
                                         Case{"da200", "TPDO1", {"0x6064", "0x6041"}},
                                         Case{"ts", "RPDO2", {"0x6040", "0x607A"}, true},
                                         Case{"sv2", "RPDO1", {"0x6040", "0x607A"}}),
                         [](const auto& each) { return std::string(each.param.family); });

const Case kTs{"ts", "RPDO2", {"0x6040", "0x607A"}};
const Case kDm{"dm", "TPDO3", {"0x6064", "0x6041"}, false, "0x3A5"};  // It tells a serial number.

TEST(PdoRecord, OfAnEarlierChangeIsNotReplacedByThatOfALaterOne) {
  World world(kTs);
  Trouble trouble;
  World measure(kTs);
  ASSERT_TRUE(measure.map());
  trouble.kill_at = measure.frames - 4;
  ASSERT_FALSE(world.map(trouble));
  ASSERT_TRUE(world.has_record());
  ASSERT_TRUE(world.map()) << world.error;
  EXPECT_NE(world.notices.find("was interrupted"), std::string::npos);
  ASSERT_TRUE(world.has_record());
  ASSERT_TRUE(world.put_back()) << world.error;
  EXPECT_EQ(world.read(), world.before);
  EXPECT_FALSE(world.has_record());
}

TEST(PdoRecord, StaysWhenTheDriveFallsSilentAndGoesWhenItRefuses) {
  World measure(kTs);
  ASSERT_TRUE(measure.map());
  for (const auto kind : {&Trouble::silent_at, &Trouble::abort_at}) {
    World world(kTs);
    Trouble trouble;
    trouble.*kind = measure.frames - 6;
    ASSERT_FALSE(world.map(trouble));
    EXPECT_EQ(world.has_record(), kind == &Trouble::silent_at);
    EXPECT_EQ(world.notices.find("was interrupted") != std::string::npos, world.has_record());
  }
}

/// How many frames the change takes; before another world, as all have one folder.
int frames_of_map() {
  World measure(kDm);
  EXPECT_TRUE(measure.map());
  return measure.frames;
}

/// Cuts a change off in the middle.
void cut_off(World& world, int frames) {
  Trouble trouble;
  trouble.kill_at = frames - 4;
  ASSERT_FALSE(world.map(trouble));
  ASSERT_TRUE(world.has_record());
}

TEST(PdoRecord, IsFoundWhateverWayTheInterfaceIsWritten) {
  const int frames = frames_of_map();
  World world(kDm);
  cut_off(world, frames);
  world.url = "socketcan:can0";
  ASSERT_TRUE(world.run("pdo show", {}));
  EXPECT_NE(world.notices.find("was interrupted"), std::string::npos);
  world.url = "can1";
  ASSERT_TRUE(world.run("pdo show", {}));
  EXPECT_EQ(world.notices.find("was interrupted"), std::string::npos);
  world.url = "socketcan:can0";
  ASSERT_TRUE(world.put_back()) << world.error;
  EXPECT_EQ(world.read(), world.before);
}

TEST(PdoRecord, OfAnotherDriveAtTheNodeIsNotPutBack) {
  const int frames = frames_of_map();
  World world(kDm);
  cut_off(world, frames);
  world.become_another();
  const auto of_the_other = world.read();
  ASSERT_TRUE(world.run("pdo show", {}));
  EXPECT_NE(world.notices.find("of another drive that was node 1"), std::string::npos) << world.notices;
  EXPECT_FALSE(world.put_back());
  EXPECT_NE(world.error.find("is not the drive"), std::string::npos) << world.error;
  EXPECT_EQ(world.read(), of_the_other);
  EXPECT_TRUE(world.has_record());
}

TEST(PdoRecord, OfAnotherDriveDoesNotKeepThisOneFromHavingItsOwn) {
  const int frames = frames_of_map();
  World world(kDm);
  cut_off(world, frames);
  world.become_another();
  cut_off(world, frames);
  EXPECT_EQ(world.records(), 2);
}

TEST(PdoRecord, ThatCannotBeWrittenKeepsTheChangeFromBeginning) {
  World world(kTs);
  fs::remove_all(world.folder());
  EXPECT_FALSE(world.map());
  EXPECT_FALSE(world.error.empty());
  EXPECT_EQ(world.read(), world.before);
}

}  // namespace
}  // namespace servoctl::commands
