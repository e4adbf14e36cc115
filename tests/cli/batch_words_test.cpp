// What is wrong in a word of any command is told before the first line of a batch file is run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "cli/batch/batch_command.hpp"
#include "cli/line_runner.hpp"
#include "command/registry.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

using command::Kind;

/// A right line of each command that takes a time, a quantity or a number, without its options.
const std::map<std::string, std::string, std::less<>> kRightLines{
    {"address", "address 9"},
    {"bus detect", "bus detect can0"},
    {"bus up", "bus up can0 --bitrate 500k"},
    {"cabinet show", "cabinet show"},
    {"cabinet swap", "cabinet swap lift"},
    {"clone", "clone --from 1 --to 2"},
    {"decode", "decode recording.log --around emcy"},
    {"doctor", "doctor"},
    {"enable", "enable"},
    {"home", "home 35"},
    {"jog", "jog 60rpm"},
    {"lss inquire", "lss inquire --only"},
    {"lss select", "lss select --only"},
    {"lss scan", "lss scan"},
    {"lss set-bitrate", "lss set-bitrate 500k --only"},
    {"lss set-node", "lss set-node 9 --only"},
    {"lss store", "lss store --only"},
    {"mode", "mode 1"},
    {"monitor", "monitor"},
    {"move", "move 1rev"},
    {"nmt watch", "nmt watch"},
    {"pdo map", "pdo map TPDO1 0x6041"},
    {"pdo watch", "pdo watch"},
    {"replay", "replay recording.log"},
    {"scan", "scan"},
    {"scope", "scope 0x6041"},
    {"sync start", "sync start"},
    {"test all", "test all 60rpm"},
    {"test comm", "test comm"},
    {"test home", "test home 35"},
    {"test io", "test io"},
    {"test jog", "test jog 60rpm"},
    {"torque", "torque 5% --for 1s --limit 60rpm"},
    {"units learn", "units learn"},
    {"units show", "units show"},
    {"watch", "watch 0x6041"},
    {"write", "write 0x6060 1"},
};
/// What only a drive tells: which objects the PDO carries.
constexpr std::string_view kOfTheDrive[] = {"pdo send"};

class BatchWords : public testing::Test {
 protected:
  /// Whether the check refuses this line as the second of a file, and what it says.
  std::string refusal(const std::string& line, const std::string& drive) {
    Shell::Options options;
    options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = "sim:" + drive + "@1,sv2@2";
    options.defaults.drive = drive;
    options.defaults.nodes = "1";
    RecordingConsole console;
    Shell shell(console, options);
    const int code = run_batch(shell, {"run", "-", "--check"}, [&] { return "read 0x6041\n" + line; });
    return code == 2 ? console.err_text : std::string();
  }

  /// The line with this word in the place of the parameter.
  static std::string with(const command::Command& of, const command::Parameter& parameter,
                          const std::string& word) {
    auto line = kRightLines.find(of.path)->second;
    if (parameter.name.starts_with("--")) {
      const auto at = line.find(std::string(parameter.name) + " ");
      if (at == std::string::npos) return fmt::format("{} {} {}", line, parameter.name, word);
      const auto begin = at + parameter.name.size() + 1;
      return line.replace(begin, line.find(' ', begin) - begin, word);
    }
    // The words of these commands are the last of their own before any option.
    const auto end = std::min(line.find(" --"), line.size());
    const auto begin = line.rfind(' ', end - 1) + 1;
    return line.replace(begin, end - begin, word);
  }
};

TEST_F(BatchWords, HoldNoNonsenseForATimeAQuantityOrANumber) {
  int tried = 0;
  for (const auto* one : command::registry()) {
    if (std::ranges::count(kOfTheDrive, one->path) > 0) continue;
    for (const auto& parameter : one->parameters) {
      if (parameter.kind != Kind::duration && parameter.kind != Kind::value && parameter.kind != Kind::number)
        continue;
      if (kRightLines.count(one->path) == 0) {
        ADD_FAILURE() << one->path << " needs a right line here";
        break;
      }
      const auto line = with(*one, parameter, "5foo");
      EXPECT_NE(refusal(line, "gsd600").find("5foo"), std::string::npos) << line;
      ++tried;
    }
  }
  EXPECT_GT(tried, 80);
}

TEST_F(BatchWords, OfMotionsAreHeldAgainstUnitsAndLimitsOfEachFamily) {
  for (const auto* drive : {"gsd600", "dm", "da200", "sv2", "ts"}) {
    for (const auto* line :
         {"jog 0rpm --for 1s", "jog 60Hz --for 1s", "jog 60rpm --for 0s", "jog 60rpm --turns x",
          "jog 60rpm --for 1s --turns 2", "jog 60rpm --for 1s --limit -60rpm",
          "jog 60rpm --for 1s --window 0deg", "move 20mm", "move 1rev --speed 0rpm", "torque 5% --for 1s",
          "jog 60rpm --for 1s -n 1,2", "jog 60rpm --for 10m"})
      EXPECT_NE(refusal(line, drive), "") << drive << ": " << line;
    for (const auto* line : {"jog 60rpm --for 1s --limit 70rpm --window 3rev", "jog -1.5rev/s --turns 0.5",
                             "move 90deg --relative --speed 30rpm", "torque -0.2Nm --for 1s --limit 60rpm"})
      EXPECT_EQ(refusal(line, drive), "") << drive << ": " << line;
  }
  EXPECT_EQ(refusal("jog 60rpm --for 1s --turn 131072 --accel 500rpm/s", "gsd600"), "");
  EXPECT_EQ(refusal("jog 60rpm --for 1s -n all", "gsd600"), "") << "all may be one";
}

TEST_F(BatchWords, LeaveNothingWrittenBeforeALineThatIsWrong) {
  Shell::Options options;
  options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.bus = "sim:gsd600@1";
  RecordingConsole console;
  Shell shell(console, options);
  const auto* text =
      "param set Pn0214 45Hz -n 1 -d gsd600\njog 60rpm --turn 131072 --for 10m -n 1 -d gsd600\n";
  EXPECT_EQ(run_batch(shell, {"run", "-"}, [&] { return std::string(text); }), 2);
  EXPECT_NE(console.err_text.find(":2: --for: '10m' is not a time"), std::string::npos) << console.err_text;
  EXPECT_EQ(shell.session(), nullptr) << "no bus was opened";
}

}  // namespace
}  // namespace servoctl::cli
