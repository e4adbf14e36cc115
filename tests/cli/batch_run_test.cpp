// Batch files on simulated drives, in virtual time.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cli/batch/batch_command.hpp"
#include "cli/line_runner.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

using Words = std::vector<std::string>;

class BatchTest : public testing::Test {
 protected:
  BatchTest() : shell(console, options()) {}

  Shell::Options options() {
    Shell::Options o;
    o.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    o.clock = sim::SimBus::Clock::virtual_time;
    o.defaults.bus = "sim:gsd600@1,gsd600@2";
    o.defaults.drive = "gsd600";
    o.cancelled = [this] { return signalled() || questions_left-- <= 0; };
    return o;
  }

  /// Runs the text as `servoctl run - OPTIONS` does.
  int run(const std::string& text, Words more = {}) {
    console.out_text.clear();
    console.err_text.clear();
    more.insert(more.begin(), {"run", "-"});
    return run_batch(shell, more, [&] { return text; });
  }

  bool told(std::string_view text) const { return console.err_text.find(text) != std::string::npos; }
  bool shown(std::string_view text) const { return console.out_text.find(text) != std::string::npos; }

  /// A signal comes while this text is shown, and is not forgotten.
  bool signalled() const {
    return !signal_at.empty() && (console.out_text + console.err_text).find(signal_at) != std::string::npos;
  }
  bool energised() {
    signal_at.clear();
    console.out_text.clear();
    EXPECT_EQ(run("status -n 1 --json"), 0) << console.err_text;
    return shown(R"("energised":true)");
  }

  std::string signal_at;
  int questions_left = 1'000'000;  ///< How often the run may ask whether it is cancelled.
  RecordingConsole console;
  Shell shell;
};

TEST_F(BatchTest, ShowsLinesAsThePromptDoesAndTheSummaryOnStderr) {
  EXPECT_EQ(run("for NODE in 1-2\nparam set Pn0214 45Hz -n ${NODE}\nexpect .value == 45\nend"), 0);
  EXPECT_TRUE(shown("   1  0x2001:0Fh  Pn0214 Speed loop gain 1  450 = 45 Hz"));
  EXPECT_TRUE(shown("   2  0x2001:0Fh  Pn0214 Speed loop gain 1  450 = 45 Hz"));
  EXPECT_TRUE(console.err_text.ends_with("standard input: 4 of 4 lines done\n")) << console.err_text;
}

TEST_F(BatchTest, ThatStopsInTheMiddleLeavesNoDriveEnergised) {
  for (const auto* up : {"enable -y", "write 0x6040 6\nwrite 0x6040 7\nwrite 0x6040 15 -y",
                         "nmt start -y\npdo send RPDO1 6 -y\npdo send RPDO1 7 -y\npdo send RPDO1 15 -y"}) {
    EXPECT_EQ(run(std::string("use 1\n") + up + "\nread 0x5FFF\nread 0x6061"), 5) << console.err_text;
    EXPECT_TRUE(told("notice: node 1 was still energised; it has been stopped and disabled\n"));
    EXPECT_EQ(run("use 1\nstatus\nexpect .energised == false"), 0) << console.out_text << console.err_text;
    EXPECT_FALSE(told("left energised"));
  }
}

TEST_F(BatchTest, ThatRunsToItsEndLeavesDrivesAsItSays) {
  EXPECT_EQ(run("use 1\nenable -y"), 0) << console.err_text;
  EXPECT_FALSE(told("was left energised; it is stopped"));
  EXPECT_EQ(run("use 1\nstatus\nexpect .energised == true\ndisable\nread 0x5FFF"), 5) << console.err_text;
  EXPECT_FALSE(told("was left energised")) << "it was disabled by the file itself";
}

TEST_F(BatchTest, ASignalInTheLastLineEndsTheRunAsInterruptedAndLeavesNoDriveEnergised) {
  for (const auto* options : {"", "-ojsonl"}) {
    SCOPED_TRACE(options);
    signal_at = "Statusword";
    const Words more = *options == '\0' ? Words() : Words{options};
    EXPECT_EQ(run("use 1\nenable -y\nwatch statusword --for 30s", more), 130)
        << console.out_text << console.err_text;
    EXPECT_TRUE(told("notice: node 1 was still energised; it has been stopped and disabled\n"))
        << console.err_text;
    EXPECT_FALSE(energised());
  }
}

TEST_F(BatchTest, ASignalWhileTheSummaryIsShownIsRememberedAsWell) {
  signal_at = "lines done";
  EXPECT_EQ(run("use 1\nenable -y\nread 0x6041"), 130) << console.err_text;
  EXPECT_FALSE(energised());
}

TEST_F(BatchTest, ASignalInTheLastLineSaysSoOfThatLine) {
  signal_at = "0x6061";
  EXPECT_EQ(run("use 1\nread 0x6041\nread 0x6061"), 130) << console.err_text;
  EXPECT_TRUE(
      told("error: standard input:3: interrupted\n  hint: all lines were run; the signal came in the last "
           "one\n"))
      << console.err_text;
}

TEST_F(BatchTest, ASignalBehindAFailureLeavesItsExitCode) {
  signal_at = "error: ";
  EXPECT_EQ(run("use 1\nread 0x5FFF\nread 0x6061"), 5) << console.err_text;
}

TEST_F(BatchTest, EndsAtTheFirstFailureWithFileLineAndItsExitCode) {
  EXPECT_EQ(run("use 1\n\nread 0x6041\nread 0x5FFF\nread 0x6061"), 5);
  EXPECT_TRUE(told("error: standard input:4: ")) << console.err_text;
  EXPECT_TRUE(told("standard input: 2 of 4 lines done, 1 failed, 1 not run\n"));
  EXPECT_FALSE(shown("0x6061"));
}

TEST_F(BatchTest, SaysInWhichRoundOfALoopItFailed) {
  EXPECT_EQ(run("for N in 1-2\nread 0x1000 -n ${N}\nexpect .node == 1\nend"), 1);
  EXPECT_TRUE(told("error: standard input:3: [0].node is 2, expected == 1 [N=2]")) << console.err_text;
  EXPECT_EQ(run("for GAIN in 45Hz 30000\nparam set Pn0202 ${GAIN} -n 1\nend"), 2);
  EXPECT_TRUE(told(" [GAIN=30000]")) << console.err_text;
}

TEST_F(BatchTest, GoesOnWhereItIsTold) {
  EXPECT_EQ(run("use 1\non-error continue\nread 0x5FFF\nread 0x6041 -n 9 --timeout 10ms\nread 0x6061"), 5);
  EXPECT_TRUE(shown("0x6061"));
  EXPECT_TRUE(told("standard input:3: "));
  EXPECT_TRUE(told("standard input:4: "));
  EXPECT_TRUE(told("2 of 4 lines done, 2 failed\n"));
  EXPECT_EQ(run("use 1\non-error continue\nread 0x5FFF\non-error stop\nexpect count == 7\nread 0x6061"), 5);
  EXPECT_FALSE(shown("0x6061"));
}

TEST_F(BatchTest, AsksTheLastResult) {
  EXPECT_EQ(run("status -n 1,2\nexpect count == 2 and .state == \"switch on disabled\"\nwait 1ms\n"
                "expect [1].node == 2"),
            0);
  EXPECT_EQ(run("status -n 1\nexpect .state == \"operation enabled\"\nscan"), 1);
  EXPECT_TRUE(told(
      "error: standard input:2: [0].state is \"switch on disabled\", expected == \"operation enabled\""));
  EXPECT_EQ(run("expect .state == 1"), 1);
}

TEST_F(BatchTest, TellsAllErrorsBeforeTheFirstLineIsRun) {
  EXPECT_EQ(
      run("param set Pn0214 45Hz -n 1\nparam set Pn0202 30000 -n 1\nfly\nread 0x6041\nparam get Pn9999 -n 1\n"
          "read statusward -n 1\nwrite 0x6060 1 --colour red -n 1\nwrite statusword 1 -n 1\nwait x\nuse 200\n"
          "run other.txt\nread 0x6041 -n 1 --type u7"),
      2);
  for (const auto* text :
       {":2: Pn0202 Position loop gain 1: 30000 is out of range", ":3: 'fly' is not a command",
        ":4: 'read' needs a node", ":5: ", ":6: ", ":7: write: there is no option '--colour'",
        ":8: 0x6041:0 Statusword is read-only", ":9: wait: 'x' is not a time", ":10: '200' is not a node-ID",
        ":11: 'run' is not allowed in a batch file", ":12: "})
    EXPECT_TRUE(told("standard input" + std::string(text))) << text << "\n" << console.err_text;
  EXPECT_FALSE(told(":1:"));
  EXPECT_EQ(shell.session(), nullptr);
  EXPECT_EQ(console.out_text, "");
}

TEST_F(BatchTest, DoesNotRefuseBeforehandWhatMayFail) {
  EXPECT_EQ(run("use 1\non-error continue\nparam get Pn9999\nread 0x6041"), 2);
  EXPECT_TRUE(shown("0x6041"));
  EXPECT_EQ(run("use 1\non-error continue\nparam get Pn9999\nread 0x6041", {"--check"}), 2);
  EXPECT_FALSE(shown("0x6041"));
}

TEST_F(BatchTest, ChecksWithoutABus) {
  EXPECT_EQ(run("use 1\nparam set Pn0214 45Hz\nread statusword", {"--check", "-b", "can77"}), 0);
  EXPECT_EQ(console.out_text, "file   standard input\nlines  3\n");
  EXPECT_EQ(run("use 1\nparam set Pn0214 99999\nread statusward", {"--check", "--json"}), 2);
  EXPECT_TRUE(shown(R"("errors":[{"code":"usage")")) << console.out_text;
  EXPECT_EQ(shell.session(), nullptr);
}

TEST_F(BatchTest, SaysWhichFamilyIsMissing) {
  shell.defaults().drive.clear();
  EXPECT_EQ(run("use 1\nparam get Pn0214"), 2);
  EXPECT_TRUE(told(":2: 'param get' needs the drive family"));
  EXPECT_EQ(run("use 1\ndrive gsd600\nparam get Pn0214"), 0);
  EXPECT_EQ(run("use 1\nparam get Pn0214 -d gsd600"), 0);
  EXPECT_EQ(run("use 1\nparam get Pn0214", {"-d", "gsd600"}), 0);
}

TEST_F(BatchTest, ShowsThePlanAndSendsNothingInADryRun) {
  EXPECT_EQ(run("for N in 1-2\n${N} w 0x1017 0 u16 500\nend\nwait 1s", {"--dry-run"}), 0);
  EXPECT_EQ(console.out_text,
            "line  command\n"
            "   2  write 0x1017:0 500 --type u16 -n 1\n"
            "   2  write 0x1017:0 500 --type u16 -n 2\n"
            "   4  wait 1s\n");
  EXPECT_EQ(shell.session(), nullptr);
  EXPECT_EQ(run("param get Pn9999 -n 1", {"--dry-run"}), 2);
}

TEST_F(BatchTest, TakesItsOptionsAsTheDefaultsOfAllLines) {
  EXPECT_EQ(run("nmt reset", {"-n", "2"}), 8);
  EXPECT_EQ(run("nmt reset --wait", {"-n", "2", "--yes"}), 0);
  EXPECT_EQ(run("read 0x1000\nexpect .node == 2", {"-n", "2"}), 0);
  EXPECT_EQ(run("read 0x1000 -n 1\nexpect .node == 1", {"-n", "2"}), 0);
  EXPECT_EQ(run("param set Pn0214 45Hz", {"-n", "2", "--read-only"}), 8);
  EXPECT_EQ(run("param set Pn0214 ${GAIN}\nexpect .value == ${GAIN}", {"-n", "2", "--var", "GAIN=44"}), 1);
  EXPECT_EQ(run("read ${A} ${B}", {"-n", "2", "--var", "A=0x1000", "--var", "B=0x1001"}), 0);
  EXPECT_EQ(run("scan", {"--var", "A"}), 2);
  EXPECT_TRUE(told("error: --var: 'A' is not NAME=VALUE"));
}

TEST_F(BatchTest, LeavesTheDefaultsOfThePromptAsTheyWere) {
  EXPECT_EQ(run("use 2\nread 0x1000", {"--json"}), 0);
  EXPECT_EQ(shell.defaults().nodes, "");
  EXPECT_FALSE(shell.defaults().json);
}

TEST_F(BatchTest, OpensItsBusOnce) {
  EXPECT_EQ(run("param set Pn0214 45Hz -n 1\nparam set Pn0214 45Hz -n 2"), 0);
  const auto* session = shell.session();
  EXPECT_EQ(run("param get Pn0214 -n 1\nexpect .value == 45"), 0);
  EXPECT_EQ(shell.session(), session);
}

TEST_F(BatchTest, WaitsOnTheClockOfTheBusAndTellsWhatItHearsMeanwhile) {
  EXPECT_EQ(run("wait 2s", {"-b", "sim:gsd600@1?fault=0xFF00@1s"}), 0);
  EXPECT_TRUE(told("notice: node 1: EMCY 0xFF00 Servo alarm")) << console.err_text;
  EXPECT_GE(shell.session()->now().time_since_epoch(), std::chrono::seconds(2));
}

TEST_F(BatchTest, PausesOnATerminalOnly) {
  EXPECT_EQ(run("pause \"remove the load\""), 0);
  EXPECT_TRUE(told("notice: no terminal, pause skipped: remove the load\n"));
  EXPECT_TRUE(console.pauses.empty());
  console.person = true;
  EXPECT_EQ(run("pause \"remove the load\""), 0);
  EXPECT_EQ(console.pauses, Words{"remove the load"});
}

TEST_F(BatchTest, EndsWith130AtCtrlC) {
  questions_left = 0;
  EXPECT_EQ(run("on-error continue\nscan\nscan"), 130);
  EXPECT_TRUE(told("error: standard input:2: interrupted"));
  EXPECT_TRUE(told("0 of 2 lines done, 2 not run\n"));
  questions_left = 20;
  EXPECT_EQ(run("on-error continue\nread 0x6041 -n 1\nwait 1min\nread 0x6041 -n 1", {"--json"}), 130);
  EXPECT_TRUE(shown(R"("summary":{"lines":3,"done":1,"failed":1}})")) << console.out_text;
}

TEST_F(BatchTest, IsOneDocumentInJson) {
  EXPECT_EQ(run("on-error continue\nread 0x5FFF -n 1\nexpect count == 2\nscan", {"--json"}), 5);
  EXPECT_EQ(std::count(console.out_text.begin(), console.out_text.end(), '\n'), 1);
  EXPECT_EQ(console.err_text, "");
  EXPECT_TRUE(console.out_text.starts_with(
      R"({"servoctl":1,"command":"run","ok":false,"bus":"sim:gsd600@1,gsd600@2","error":{"code":"sdo-abort","exit":5,"message":"standard input:2: )"))
      << console.out_text;
  EXPECT_TRUE(
      shown(R"("result":{"lines":[{"line":2,"text":"read 0x5FFF -n 1","command":"read","ok":false,)"));
  EXPECT_TRUE(shown(
      R"({"line":3,"text":"expect count == 2","command":"expect","ok":false,"result":null,"error":{"code":"negative")"));
  EXPECT_TRUE(shown(R"("summary":{"lines":3,"done":1,"failed":2}},"notices":[]})"));
}

TEST_F(BatchTest, IsADocumentALineInJsonl) {
  EXPECT_EQ(run("read 0x1000 -n 1\nread 0x1001 -n 1", {"-o", "jsonl"}), 0);
  EXPECT_EQ(std::count(console.out_text.begin(), console.out_text.end(), '\n'), 3);
  EXPECT_TRUE(
      console.out_text.starts_with(R"({"line":1,"text":"read 0x1000 -n 1","command":"read","ok":true,)"));
  EXPECT_TRUE(console.out_text.ends_with(
      R"("result":{"lines":null,"summary":{"lines":2,"done":2,"failed":0}},"notices":[]})"
      "\n"));
}

TEST_F(BatchTest, EndsAtExit) {
  EXPECT_EQ(run("scan\nexit\nread 0x5FFF -n 1"), 0);
  EXPECT_TRUE(told("2 of 3 lines done, 1 not run\n"));
}

TEST_F(BatchTest, RunsFromThePromptButNotFromItsOwnInput) {
  LineRunner runner(shell);
  EXPECT_EQ(runner.run("run -"), 2);
  EXPECT_TRUE(told("standard input already supplies these lines"));
  EXPECT_EQ(runner.run("run no/such/file"), 7);
  EXPECT_EQ(runner.run("run"), 2);
  EXPECT_EQ(runner.run("run --help"), 0);
  const auto path = testing::TempDir() + "batch_run_test.txt";
  std::ofstream(path) << "use 2\nread 0x1000\nexpect .node == 2\n";
  EXPECT_EQ(runner.run("run " + path), 0);
  std::filesystem::remove(path);
}

TEST_F(BatchTest, SyncGoesOnBehindTheLineThatStartsIt) {
  EXPECT_EQ(run("use 1\nsync start --period 2ms --counter 10 -y\nwait 99ms\nread 0x6041\nsync stop"), 0)
      << console.err_text;
  EXPECT_TRUE(shown("running"));
  EXPECT_TRUE(shown("   50 ")) << console.out_text;  // 0, 2, … 98 ms.
  EXPECT_FALSE(told("no longer produced"));
}

TEST_F(BatchTest, SyncEndsWithTheFile) {
  EXPECT_EQ(run("sync start -y\nwait 25ms"), 0);
  EXPECT_TRUE(told("notice: SYNC is no longer produced on sim:gsd600@1,gsd600@2, after 3\n"))
      << console.err_text;
  EXPECT_EQ(run("sync start -y\nread 0x5FFF -n 1"), 5);
  EXPECT_TRUE(told("SYNC is no longer produced"));
  EXPECT_EQ(run("sync stop"), 2);
  EXPECT_TRUE(told("no SYNC is produced here"));
}

TEST_F(BatchTest, ThereIsOneSyncAtATime) {
  for (const auto* second : {"sync start -y", "sync once -y", "sync start --for 10ms -y"}) {
    EXPECT_EQ(run(std::string("sync start --period 5ms -y\n") + second), 8);
    EXPECT_TRUE(told("SYNC is already being produced, every 5 ms"));
  }
  EXPECT_EQ(run("sync start --period 5ms -y\nsync stop\nsync once -y\nsync start --for 10ms -y"), 0);
}

TEST_F(BatchTest, SyncIsNotTakenFromADriveThatFollowsItWithoutAWord) {
  const std::string up = "use 1\nnmt start -y\nwrite 0x6060 7\nenable -y\n";
  for (const auto* end : {"sync stop", ""}) {
    EXPECT_EQ(run(up + "sync start --period 2ms -y\nwait 50ms\n" + end), 0) << console.err_text;
    EXPECT_TRUE(told("node 1 is energised in a mode that follows SYNC")) << console.err_text;
    EXPECT_EQ(run("use 1\ndisable"), 0) << console.err_text;
  }
  EXPECT_EQ(run(up + "sync start --period 2ms -y\ndisable\nsync stop"), 0) << console.err_text;
  EXPECT_FALSE(told("follows SYNC"));
}

TEST_F(BatchTest, SyncObeysReadOnlyAndDryRun) {
  EXPECT_EQ(run("sync start -y", {"--read-only"}), 8);
  EXPECT_EQ(run("sync start -y", {"--dry-run"}), 0);
  EXPECT_FALSE(told("no longer produced"));
}

}  // namespace
}  // namespace servoctl::cli
