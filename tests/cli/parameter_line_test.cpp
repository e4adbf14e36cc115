// A line of the prompt that begins with the number of a panel parameter.
#include <gtest/gtest.h>

#include <filesystem>

#include "cli/line_runner.hpp"
#include "cli/terminal/prompt_words.hpp"
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
  for (const auto* word : {"can0", "jog", "0x6041", "6041", "use", "-n1", "stop", "P", "Pn0214x"})
    EXPECT_EQ(as_parameter_line({word}), LineWords{word});
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
