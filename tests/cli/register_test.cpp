// Commands where drives are known by registers alone.
#include <gtest/gtest.h>

#include "cli/admission.hpp"
#include "command/registry.hpp"
#include "session/modbus_network.hpp"
#include "sim/modbus_port.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;
using command::Effect;
using command::Needs;

const std::vector<fs::path> kRegisterFolders{fs::path(source_dir()) / "eds"};

class OnRegisters : public testing::Test {
 protected:
  OnRegisters() {
    auto port = sim::open_modbus_sim("ts@1", kRegisterFolders, sim::SimClock::Kind::virtual_time);
    session.emplace(std::make_unique<session::ModbusNetwork>(std::move(*port), "modbus:sim:ts@1"),
                    "modbus:sim:ts@1", session::Options{});
    ts = std::move(*drive::load_profile("ts", kRegisterFolders));
    gsd600 = std::move(*drive::load_profile("gsd600", kRegisterFolders));
  }
  bool works(const command::Command& command, const drive::Profile* profile) {
    const auto possible = check_registers(command, *session, profile, false);
    if (!possible) {
      EXPECT_EQ(possible.error().code, Errc::usage) << command.path;
    }
    return possible.has_value();
  }

  std::optional<session::Session> session;
  drive::Profile ts;
  drive::Profile gsd600;
};

TEST_F(OnRegisters, NothingThatMovesADriveWorks) {
  for (const auto* command : command::registry())
    if (command->effect >= Effect::moves || includes(command->needs, Needs::can) ||
        includes(command->needs, Needs::nmt) || includes(command->needs, Needs::ethercat)) {
      EXPECT_FALSE(works(*command, &ts)) << command->path;
    }
}

TEST_F(OnRegisters, WorksWhatNeedsParametersAlone) {
  std::vector<std::string> found;
  for (const auto* command : command::registry())
    if (works(*command, &ts)) found.emplace_back(command->path);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, (std::vector<std::string>{"backup", "clone", "diff", "fault show", "info", "param get",
                                             "param set", "read", "restore", "scan", "scope", "verify",
                                             "watch", "write"}));
}

TEST_F(OnRegisters, AFamilyWithoutRegistersIsRefused) {
  for (const auto* path : {"read", "scan", "backup"})
    EXPECT_FALSE(works(*command::find_command(path), &gsd600)) << path;
}

TEST_F(OnRegisters, MotionSaysWhatTheDriveHasInstead) {
  const auto possible = check_registers(*command::find_command("jog"), *session, &ts, false);
  ASSERT_FALSE(possible);
  EXPECT_NE(possible.error().hint.text().find("Fn_33"), std::string::npos);
  EXPECT_NE(possible.error().hint.text().find("Nothing stops the motor"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::cli
