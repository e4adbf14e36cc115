// `undo` on simulated drives, in virtual time; tests/cli/prompt_memory_test.py has what is said of it at a
// prompt.
#include <gtest/gtest.h>

#include <filesystem>

#include "cli/line_runner.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

class UndoTest : public testing::Test {
 protected:
  UndoTest() : shell(console, options()), runner(shell) { shell.stay_open(true); }

  Shell::Options options() {
    Shell::Options o;
    o.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    o.clock = sim::SimBus::Clock::virtual_time;
    o.defaults.bus = "sim:gsd600@1";
    o.defaults.drive = "gsd600";
    o.defaults.nodes = "1";
    o.cancelled = [this] { return questions_left-- <= 0; };
    return o;
  }

  int run(const std::string& line) {
    console.out_text.clear();
    console.err_text.clear();
    return runner.run(line);
  }
  bool told(std::string_view text) const { return console.err_text.find(text) != std::string::npos; }

  static constexpr int kNever = 1'000'000;
  int questions_left = kNever;  ///< How often the line may ask whether it is cancelled.
  RecordingConsole console;
  Shell shell;
  LineRunner runner;
};

TEST_F(UndoTest, CutOffAnywhereGoesOnWithTheRest) {
  int cut_off = 0;
  int in_the_middle = 0;
  for (int most = 1;; ++most) {
    SCOPED_TRACE(most);
    ASSERT_EQ(run("param set Pn0214=400 Pn0215=300"), 0) << console.err_text;
    questions_left = most;
    const int code = run("undo --yes");
    questions_left = kNever;
    if (code != 0) {
      ++cut_off;
      if (told("1 of 2 values are put back; `undo` goes on with the others")) ++in_the_middle;
      ASSERT_EQ(run("undo --yes"), 0) << console.err_text;
    }
    ASSERT_EQ(run("param get Pn0214 Pn0215"), 0);
    EXPECT_NE(console.out_text.find("600 = 60 Hz"), std::string::npos) << console.out_text;
    EXPECT_NE(console.out_text.find("1000 = 10 ms"), std::string::npos) << console.out_text;
    if (code == 0) break;
  }
  EXPECT_GT(cut_off, 3);
  EXPECT_GT(in_the_middle, 0);
}

TEST_F(UndoTest, RefusesADriveThatWasSwappedMeanwhile) {
  ASSERT_EQ(run("param set Pn0214=400"), 0) << console.err_text;
  ASSERT_EQ(run("bus sim:dm@1"), 0);
  // The bus has its old name, and another drive at the node.
  ASSERT_NE(shell.last_write().line(), nullptr);
  auto line = *shell.last_write().line();
  line.bus = "sim:dm@1";
  shell.last_write().keep(line);
  EXPECT_EQ(run("undo --yes"), 8);
  EXPECT_TRUE(told("is another drive than the one that was written to")) << console.err_text;
}

TEST_F(UndoTest, RefusesASetPointUnderAnyName) {
  struct Row {
    const char* bus;
    const char* family;
    const char* write;
    const char* same;
  };
  const Row rows[] = {{"sim:da200@1", "da200", "write P4.13 100", "param set P4.13 0"},
                      {"sim:da200@1", "da200", "write P4.14 10", "write P4.14 0"},
                      {"sim:da200@1", "da200", "write P6.01 1000", "write 0x2601 0"},
                      {"sim:da200@1", "da200", "write 0x60FF 100", "write 0x60FF 0"},
                      {"sim:ts@1", "ts", "param set Fn_33=100", "param set Fn_33=0"}};
  for (const auto& row : rows) {
    SCOPED_TRACE(row.write);
    ASSERT_EQ(run(std::string("bus ") + row.bus), 0) << console.err_text;
    ASSERT_EQ(run(std::string("drive ") + row.family), 0) << console.err_text;
    ASSERT_EQ(run(row.write), 0) << console.err_text;
    ASSERT_EQ(run(row.same), 0) << console.err_text;
    EXPECT_EQ(run("undo --yes"), 8) << console.out_text;
    EXPECT_TRUE(told("it drives the motor, and is no setting")) << console.err_text;
  }
}

TEST_F(UndoTest, TakesNothingButYes) {
  ASSERT_EQ(run("param set Pn0214=400"), 0) << console.err_text;
  for (const auto* line : {"undo -n 2", "undo --dry-run", "undo --yes --yes"}) {
    EXPECT_EQ(run(line), 2) << line;
    EXPECT_TRUE(told("'undo' takes nothing but --yes")) << console.err_text;
  }
  ASSERT_EQ(run("param get Pn0214"), 0);
  EXPECT_NE(console.out_text.find("400 = 40 Hz"), std::string::npos) << console.out_text;
}

}  // namespace
}  // namespace servoctl::cli
