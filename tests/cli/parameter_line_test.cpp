// A line of the prompt that begins with the number of a panel parameter.
#include <gtest/gtest.h>

#include <filesystem>

#include "cli/line_runner.hpp"
#include "cli/terminal/prompt_words.hpp"
#include "drive/profile.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

using LineWords = std::vector<std::string>;

TEST(ParameterLine, StandsForGetAndSet) {
  EXPECT_EQ(as_parameter_line({"Pn0214"}), (LineWords{"param", "get", "Pn0214"}));
  EXPECT_EQ(as_parameter_line({"Fn_33", "-n", "2"}), (LineWords{"param", "get", "Fn_33", "-n", "2"}));
  const LineWords sets{"param", "set", "Pn0214=45Hz", "--keep"};
  EXPECT_EQ(as_parameter_line({"Pn0214=45Hz", "--keep"}), sets);
  EXPECT_EQ(as_parameter_line({"Pn0214", "=", "45Hz", "--keep"}), sets);
  EXPECT_EQ(as_parameter_line({"Pn0214", "=45Hz", "--keep"}), sets);
  EXPECT_EQ(as_parameter_line({"Pn0214=", "45Hz", "--keep"}), sets);
  EXPECT_EQ(as_parameter_line({"P0.03=", "-5"}), (LineWords{"param", "set", "P0.03=-5"}));
}

TEST(ParameterLine, TakesNoOptionForAValueAndNoValueWithoutASign) {
  EXPECT_EQ(as_parameter_line({"Pn0214", "=", "-n", "2"}), (LineWords{"param", "set", "Pn0214=", "-n", "2"}));
  EXPECT_EQ(as_parameter_line({"Pn0214", "45Hz"}), (LineWords{"param", "get", "Pn0214", "45Hz"}));
  for (const auto* word : {"can0", "jog", "0x6041", "6041", "use", "-n1", "stop", "P", "Pn0214x", "Fn_",
                           "P3-", "P3-x", "P3.30-", "a-b", "Pn021A", "P.3"})
    EXPECT_EQ(as_parameter_line({word}), LineWords{word});
}

TEST(ParameterLine, TakesEveryPanelNumberOfEveryFamily) {
  const std::vector folders{std::filesystem::path(source_dir()) / "eds"};
  std::size_t count = 0;
  for (const auto& family : drive::find_families(folders)) {
    const auto profile = drive::load_profile(family, folders);
    ASSERT_TRUE(profile) << family.name;
    if (profile->made_of_dictionary) continue;
    for (const auto& parameter : profile->parameters) {
      const auto& id = parameter.id;
      EXPECT_EQ(as_parameter_line({id}), (LineWords{"param", "get", id})) << family.name;
      EXPECT_EQ(as_parameter_line({id + "=1"}), (LineWords{"param", "set", id + "=1"})) << family.name;
      ++count;
    }
  }
  EXPECT_GT(count, 700U);
}

/// What a line of the prompt answers, of a simulated drive.
std::string answer_at_prompt(const std::string& bus, const std::string& family, const std::string& line) {
  Shell::Options options;
  options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.bus = bus;
  options.defaults.drive = family;
  options.defaults.nodes = "1";
  RecordingConsole console;
  Shell shell(console, options);
  const auto code = LineRunner(shell).run(line);
  return std::to_string(code) + " " + console.out_text + console.err_text;
}

TEST(ParameterLine, ReadsAndSetsNumbersOfGroupsAndHexadecimalOnes) {
  EXPECT_TRUE(answer_at_prompt("modbus:sim:ts@1", "ts", "Fn_20B").starts_with("0 "));
  EXPECT_TRUE(answer_at_prompt("modbus:sim:ts@1", "ts", "Fn_20B=1 --dry-run").starts_with("0 "))
      << answer_at_prompt("modbus:sim:ts@1", "ts", "Fn_20B=1 --dry-run");
  EXPECT_TRUE(answer_at_prompt("modbus:sim:ts@1", "ts", "fn_20b = 99999").starts_with("2 "));
  // The manual gives P3-30 no object: the refusal is that of `param get`.
  const auto refused = answer_at_prompt("coe:sim:sv2@1", "sv2", "P3-30");
  EXPECT_NE(refused.find("P3-30"), std::string::npos) << refused;
  EXPECT_EQ(refused, answer_at_prompt("coe:sim:sv2@1", "sv2", "param get P3-30"));
}

TEST(ParameterLine, IsRefusedLikeTheCommandAndThenWritesNothing) {
  Shell::Options options;
  options.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
  options.clock = sim::SimBus::Clock::virtual_time;
  options.defaults.bus = "sim:gsd600@1";
  options.defaults.drive = "gsd600";
  options.defaults.nodes = "1";
  RecordingConsole console;
  Shell shell(console, options);
  LineRunner runner(shell);
  for (const auto* line : {"Pn0214=", "Pn0214 45Hz", "Pn0214 = 45 Hz", "Pn0214=99999Hz", "Pn0214==45",
                           "Pn9999=1", "Pn0214=45Hz --read-only"})
    EXPECT_NE(runner.run(line), 0) << line;
  console.out_text.clear();
  EXPECT_EQ(runner.run("Pn0214"), 0);
  EXPECT_NE(console.out_text.find("600 = 60 Hz"), std::string::npos) << console.out_text;
  EXPECT_EQ(runner.run("Pn0214 = 45Hz"), 0) << console.err_text;
  EXPECT_EQ(runner.run("Pn0214"), 0);
  EXPECT_NE(console.out_text.find("450 = 45 Hz"), std::string::npos) << console.out_text;
}

}  // namespace
}  // namespace servoctl::cli
