// The Chinese words that `status` has for the states are words that `explain` knows.
#include <gtest/gtest.h>

#include "cli/shell.hpp"
#include "drive/cia402.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

TEST(ExplainStates, EveryChineseNameThatIsShownIsExplainedInEachFamily) {
  using drive::DriveState;
  for (const auto* family : {"gsd600", "dm", "da200", "sv2", "ts"}) {
    RecordingConsole console;
    Shell::Options options;
    options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    Shell shell(console, options);
    for (const auto state :
         {DriveState::not_ready_to_switch_on, DriveState::switch_on_disabled, DriveState::ready_to_switch_on,
          DriveState::switched_on, DriveState::operation_enabled, DriveState::quick_stop_active,
          DriveState::fault_reaction_active, DriveState::fault}) {
      const std::string name(drive::name_zh(state));
      console.out_text.clear();
      EXPECT_EQ(shell.run({"explain", name, "-d", family, "--lang", "zh"}), 0)
          << family << " " << name << "\n"
          << console.err_text;
      EXPECT_NE(console.out_text.find("状态"), std::string::npos) << family << " " << name << "\n"
                                                                  << console.out_text;
    }
  }
}

}  // namespace
}  // namespace servoctl::cli
