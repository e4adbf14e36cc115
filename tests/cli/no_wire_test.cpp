// The commands on a network that has no wire: a drive model in memory, no frame anywhere.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>

#include "cli/shell.hpp"
#include "command/registry.hpp"
#include "sim/drive_model.hpp"
#include "tests/session/memory_network.hpp"
#include "tests/show/audiences.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using command::Arguments;
using session::MemoryNetwork;
using session::NodeEvent;
using session::NodeState;

class NoWire : public testing::TestWithParam<const char*> {
 protected:
  NoWire()
      : profile(drive::load_profile(GetParam(), kFolders).value()),
        model(profile, 1, memory, "1"),
        folder_(fs::temp_directory_path() / ("servoctl-no-wire-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    auto owned = std::make_unique<MemoryNetwork>();
    auto& network = *owned;
    model.power_on(network.now());
    auto& node = network.add(1, model);
    node.on_time = [this](TimePoint now) { model.on_time(now); };
    node.deadline = [this, &network] { return std::min(model.deadline(), network.now() + 1ms); };
    node.on_state = [this](NodeState state) {
      model.set_operational(state == NodeState::operational);
      return true;
    };
    node.take_event = [this]() -> std::optional<NodeEvent::What> {
      const auto told = model.take_emergency();
      if (!told) return std::nullopt;
      return canopen::Emergency{
          .node = 1, .code = told->code, .error_register = told->error_register, .vendor = told->vendor};
    };
    session.emplace(std::move(owned), "memory", session::Options{});
  }
  ~NoWire() override { fs::remove_all(folder_); }

  Result<report::Value> run(std::string_view path,
                            std::initializer_list<std::pair<std::string_view, std::string>> words = {}) {
    Arguments arguments;
    for (const auto& [name, value] : words) arguments.add(name, value);
    command::Context context;
    context.session = &*session;
    context.profile = &profile;
    context.drive_folders = kFolders;
    context.nodes = {1};
    context.audience = &willing_;
    const auto* found = command::find_command(path);
    EXPECT_TRUE(check_network(*found, *session)) << path;
    auto done = found->run(context, arguments);
    EXPECT_TRUE(done) << path << ": " << done.error().message.text();
    for (const auto& error : context.errors) ADD_FAILURE() << path << ": " << error.message.text();
    return done;
  }
  std::string file(std::string_view name) const { return (folder_ / name).string(); }
  Bytes held(ObjectAddress object) {
    Bytes out;
    EXPECT_EQ(model.read(object, out), 0U);
    return out;
  }

  drive::Profile profile;
  sim::Memory memory;
  sim::DriveModel model;
  std::optional<session::Session> session;

 private:
  fs::path folder_;
  show::Willing willing_;
};

TEST_P(NoWire, ADriveIsIdentifiedReadAndWritten) {
  const auto info = report::to_json(*run("info"));
  Bytes type;
  ASSERT_EQ(model.read({0x1000, 0}, type), 0U);
  EXPECT_NE(info.find("\"device_type\":" + std::to_string(load_le(type))), std::string::npos) << info;
  const auto before = held({0x6065, 0});
  (void)run("write", {{"object", "0x6065"}, {"value", "4321"}});
  EXPECT_EQ(load_le(held({0x6065, 0})), 4321U);
  EXPECT_NE(report::to_json(*run("read", {{"object", "0x6065"}})).find("4321"), std::string::npos);
  EXPECT_NE(before, held({0x6065, 0}));
}

TEST_P(NoWire, SettingsAreBackedUpAndPutBack) {
  (void)run("backup", {{"file", file("one.json")}});
  const auto before = held({0x6065, 0});
  (void)run("write", {{"object", "0x6065"}, {"value", "4321"}});
  ASSERT_NE(held({0x6065, 0}), before);
  (void)run("restore", {{"file", file("one.json")}});
  EXPECT_EQ(held({0x6065, 0}), before);
}

TEST_P(NoWire, AMotorTurnsAndIsLeftWithoutPower) {
  const double at_first = static_cast<double>(static_cast<std::int32_t>(load_le(held({0x6064, 0}))));
  const auto jog = report::to_json(*run("jog", {{"speed", "60rpm"}, {"--for", "1s"}, {"--turn", "10000"}}));
  EXPECT_NE(jog.find(R"("watchdog":"none)"), std::string::npos)
      << "nothing tells the drive that servoctl lives: " << jog;
  EXPECT_GT(std::abs(static_cast<double>(static_cast<std::int32_t>(load_le(held({0x6064, 0})))) - at_first),
            1000);
  EXPECT_EQ(model.power_state(), drive::DriveState::switch_on_disabled);
  EXPECT_FALSE(model.is_moving());
}

INSTANTIATE_TEST_SUITE_P(Families, NoWire, testing::Values("cia402", "gsd600"),
                         [](const auto& family) { return std::string(family.param); });

TEST(NetworkOfNoCan, RefusesWhatSpeaksInFramesAndNothingElse) {
  session::Session session(std::make_unique<MemoryNetwork>(), "memory", {});
  for (const auto* path :
       {"nmt start", "nmt watch", "sync once", "sync start", "pdo send", "monitor", "replay"}) {
    const auto possible = check_network(*command::find_command(path), session);
    ASSERT_FALSE(possible) << path;
    EXPECT_EQ(possible.error().code, Errc::usage) << path;
  }
  for (const auto* path : {"read", "write", "status", "backup", "restore", "jog", "home", "watch", "scope",
                           "pdo map", "fault show", "store"})
    EXPECT_TRUE(check_network(*command::find_command(path), session)) << path;
}

}  // namespace
}  // namespace servoctl::cli
