// Batch files: statements, variables, loops, lines of CiA 309-3, and the lines that errors name.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>

#include "cli/batch/batch_plan.hpp"
#include "cli/batch/gateway_line.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

using Words = std::vector<std::string>;

Plan plan(std::string_view text, Variables variables = {}) {
  auto batch = parse_batch(text);
  auto out = plan_batch(batch, std::move(variables), source_dir() + "/tests/cli/data");
  out.errors.insert(out.errors.begin(), batch.errors.begin(), batch.errors.end());
  return out;
}

/// `LINE TEXT` of every step, errors as `LINE! MESSAGE`.
Words said(std::string_view text, Variables variables = {}) {
  Words out;
  const auto made = plan(text, std::move(variables));
  for (const auto& step : made.steps) out.push_back(std::to_string(step.line) + " " + step.text);
  for (const auto& error : made.errors)
    out.push_back(std::to_string(error.line.value()) + "! " + error.message.text());
  return out;
}

TEST(BatchFile, HoldsOneLineALineAndSkipsCommentsAndEmptyOnes) {
  EXPECT_EQ(said("#!/usr/bin/env -S servoctl run\n\nscan\n  # a comment\n\tread 0x6041 # behind\n"),
            (Words{"3 scan", "5 read 0x6041"}));
  EXPECT_EQ(said("\xEF\xBB\xBFscan\r\nread 0x6041\r\n"), (Words{"1 scan", "2 read 0x6041"}));
  EXPECT_EQ(said(""), Words{});
  EXPECT_EQ(said("scan"), Words{"1 scan"});
}

TEST(BatchFile, ContinuesALineBehindABackslashAndKeepsItsNumber) {
  EXPECT_EQ(said("read \\\n  0x6041 \\\r\n  0x6061\nscan"), (Words{"1 read 0x6041 0x6061", "4 scan"}));
  EXPECT_EQ(said("re\\\nad 0x6041"), Words{"1 read 0x6041"});
  EXPECT_EQ(said("# no continuation \\\nscan"), Words{"2 scan"});
  EXPECT_EQ(said("read a\\\\\nscan"), (Words{"1 read \"a\\\\\"", "2 scan"}));
  EXPECT_EQ(said("scan \\"), Words{"1 scan"});
}

TEST(BatchFile, SplitsAndQuotesAsAShellDoes) {
  EXPECT_EQ(plan("write x 'two words' \"a b\"").steps.at(0).words, (Words{"write", "x", "two words", "a b"}));
  EXPECT_EQ(said("write x 'two words' \"\" \"#\""), Words{"1 write x \"two words\" \"\" \"#\""});
}

TEST(BatchVariables, AreReplacedOutsideSingleQuotes) {
  EXPECT_EQ(said("set A=5 B='two words'\nwrite ${A} \"${B}\" '${A}' x${A}y \\${A} $A"),
            Words{"2 write 5 \"two words\" \"\\${A}\" x5y \"\\${A}\" $A"});
}

TEST(BatchVariables, StayOneWordWhateverTheyHold) {
  EXPECT_EQ(plan("set A=\"1 --yes; #\"\nwrite ${A}").steps.at(0).words, (Words{"write", "1 --yes; #"}));
  EXPECT_EQ(plan("set A=\nwrite ${A}").steps.at(0).words, (Words{"write", ""}));
}

TEST(BatchVariables, OfTheCommandLineWinOverTheFile) {
  Variables variables;
  ASSERT_TRUE(variables.fix("A=7"));
  EXPECT_EQ(said("set A=5\nset B=${A}\nread ${A} ${B}", variables), Words{"3 read 7 7"});
  for (const auto* wrong : {"A", "=5", "1A=5", "A B=5", "A-B=5"}) EXPECT_FALSE(variables.fix(wrong)) << wrong;
}

TEST(BatchVariables, ThatNobodySetAreRefusedWithTheNearestName) {
  const auto made = plan("set GAIN=5\nread ${GIAN}\nread ${OTHER\nread ${}");
  ASSERT_EQ(made.errors.size(), 3U);
  EXPECT_EQ(made.errors[0].message.text(), "unknown variable ${GIAN}");
  EXPECT_NE(made.errors[0].hint.text().find("GAIN"), std::string::npos);
  EXPECT_EQ(made.errors[1].message.text(), "the brace of ${ is not closed");
}

TEST(BatchVariables, ThatGrowWithoutEndAreRefused) {
  EXPECT_EQ(said("set A=0123456789\nfor I in 1-64\nset A=${A}${A}\nend"),
            Words{"3! the value of A is too long [I=9]"});
}

TEST(BatchLoop, TakesListsRangesAndWords) {
  EXPECT_EQ(said("for N in 1,3,5-7\nread -n ${N}\nend"),
            (Words{"2 read -n 1", "2 read -n 3", "2 read -n 5", "2 read -n 6", "2 read -n 7"}));
  EXPECT_EQ(said("for W in Pn0214 010 a-b \"x y\"\nread ${W}\nend"),
            (Words{"2 read Pn0214", "2 read 010", "2 read a-b", "2 read \"x y\""}));
  EXPECT_EQ(said("set LIST=1-2\nfor N in ${LIST} 9\nread ${N}\nend\nscan"),
            (Words{"3 read 1", "3 read 2", "3 read 9", "5 scan"}));
}

TEST(BatchLoop, StandsInAnotherOne) {
  EXPECT_EQ(said("for A in 1-2\nfor B in x y\nread ${A}${B}\nend # inner\nread ${A}\nend\n"),
            (Words{"3 read 1x", "3 read 1y", "5 read 1", "3 read 2x", "3 read 2y", "5 read 2"}));
}

TEST(BatchLoop, TakesTheLinesOfACsvFileBesideIt) {
  EXPECT_EQ(said("for AXIS in axes.csv\nparam set Pn0214=${AXIS.gain} -n ${AXIS.node} # ${AXIS.note\n"
                 "expect .name == \"${AXIS.note}\"\nend"),
            (Words{"2 param set Pn0214=45Hz -n 1", "3 expect .name == \"X, left\"",
                   "2 param set Pn0214=50Hz -n 2", "3 expect .name == \"Y\""}));
  EXPECT_EQ(said("for AXIS in axes.csv\nread ${AXIS.volts}\nend"),
            Words{"2! unknown variable ${AXIS.volts} [AXIS=axes.csv:2]"});
  EXPECT_EQ(said("for AXIS in nobody.csv\nend").size(), 1U);
  EXPECT_EQ(said("for AXIS in axes.csv 1\nend"), Words{"1! a CSV file must stand alone in its list"});
}

TEST(BatchLoop, WithoutSenseIsRefused) {
  EXPECT_EQ(said("scan\nfor N in 1-2\nread ${N}"),
            (Words{"1 scan", "3 read 1", "3 read 2", "2! 'for' has no 'end'"}));
  EXPECT_EQ(said("end"), Words{"1! 'end' without 'for'"});
  for (const auto* head : {"for", "for N", "for N in", "for N of 1-3", "for 1 in 1-3", "for N in # 1"})
    EXPECT_EQ(said(std::string(head) + "\nread ${N}\nend"), Words{"1! 'for' needs a name and a list"})
        << head;
  EXPECT_EQ(said("for N in 8-5\nend"), Words{"1! '8-5' runs backwards"});
  EXPECT_EQ(said("for N in 1-99999999\nend"), Words{"1! '1-99999999' is too long a list"});
}

TEST(BatchLoop, ThatNeverEndsIsRefused) {
  EXPECT_EQ(said("for A in 1-1000\nfor B in 1-1000\nfor C in 1-1000\nend\nend\nend"),
            Words{"3! the loops make more than 20000 lines [A=1 B=20]"});
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "for A in 1-2\n";
  EXPECT_FALSE(parse_batch(deep).errors.empty());
}

TEST(BatchVariables, DoNotMakeAFileWithoutEnd) {
  const std::string four_kib(4'000, 'x');
  std::string line = "set L=" + four_kib + "\nread ";
  for (int i = 0; i < 300; ++i) line += "${L}";
  EXPECT_EQ(said(line), Words{"2! its variables make the line longer than 1 MiB"});
  line = "set L=" + four_kib + "\nexpect ";
  for (int i = 0; i < 300; ++i) line += "${L}";
  EXPECT_EQ(said(line), Words{"2! its variables make the line longer than 1 MiB"});
  line = "set L=" + four_kib + "\nfor A in 1-10000\nread ${L}${L}\nend";
  const auto made = plan(line);
  ASSERT_EQ(made.errors.size(), 1U);
  EXPECT_EQ(made.errors[0].message.text().substr(0, 57),
            "with its variables expanded the file exceeds 16 MiB [A=20");
  EXPECT_LT(made.steps.size(), 2'200U);
}

TEST(BatchLoop, ReadsItsTableOnceHoweverOftenItStandsInAnother) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("servoctl-loops-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  {
    std::ofstream table(folder / "t.csv");
    table << "n\n";
    for (int i = 0; i < 10; ++i) table << i << "\n";
    // Read once it is nothing; read in every round it would take minutes.
    for (int i = 0; i < 500'000; ++i) table << "\n";
  }
  const auto batch = parse_batch("for A in 1-1500\nfor R in t.csv\nread ${R.n}\nend\nend");
  EXPECT_EQ(plan_batch(batch, {}, folder).steps.size(), 15'000U);
  std::filesystem::remove_all(folder);
}

TEST(BatchStatement, WaitPauseAndOnErrorAreTakenApart) {
  const auto made = plan("wait 2s\npause \"take it away\"\non-error continue\nscan\non-error stop\nscan");
  ASSERT_EQ(made.steps.size(), 4U);
  EXPECT_EQ(made.steps[0].duration, std::chrono::seconds(2));
  EXPECT_EQ(made.steps[1].words, Words{"take it away"});
  EXPECT_FALSE(made.steps[1].goes_on);
  EXPECT_TRUE(made.steps[2].goes_on);
  EXPECT_FALSE(made.steps[3].goes_on);
}

TEST(BatchStatement, ErrorsNameTheirLinesAllAtOnce) {
  EXPECT_EQ(said("wait\nwait soon\non-error\non-error go\nset A\nset\nread \"open\nexpect\nexpect .a = 5\n"
                 "4 r 0x1000\nscan"),
            (Words{"11 scan", "1! 'wait' takes a time", "2! wait: 'soon' is not a time",
                   "3! 'on-error' takes one word", "4! 'on-error' takes one word", "5! 'A' is not NAME=VALUE",
                   "6! 'set' needs NAME=VALUE", "7! the quote \" is not closed",
                   "8! a value is missing in the expression", "9! '=' compares nothing",
                   "10! CiA 309-3: a read takes INDEX SUB [TYPE]"}));
}

TEST(BatchStatement, ThatALoopRepeatsIsRefusedOnceWithItsRound) {
  EXPECT_EQ(said("for N in 1-40\nwait\nend"), Words{"2! 'wait' takes a time [N=1]"});
  EXPECT_EQ(said("for N in 1-2\nfor AXIS in axes.csv\nset A=${N}${AXIS.volts} ${AXIS.node}\nset "
                 "${AXIS.node}\nend\nend"),
            (Words{"3! unknown variable ${AXIS.volts} [N=1 AXIS=axes.csv:2]",
                   "4! '1' is not NAME=VALUE [N=1 AXIS=axes.csv:2]",
                   "4! '2' is not NAME=VALUE [N=1 AXIS=axes.csv:3]"}));
  const auto made = plan("for AXIS in axes.csv\nread 0x1000\nend\nscan");
  EXPECT_EQ(made.steps.at(1).round, "AXIS=axes.csv:3");
  EXPECT_EQ(made.steps.at(2).round, "");
}

/// The line of ours that a line of CiA 309-3 becomes; `-` when it is none, `!` when it is wrong.
std::string gateway(std::string_view line) {
  const auto words = from_gateway_line(split_words(line).value());
  if (!words) return "-";
  return *words ? join_words(**words) : "!";
}

TEST(GatewayLine, BecomesALineOfOurs) {
  EXPECT_EQ(gateway("r 0x1000 0 u32"), "read 0x1000:0 --type u32");
  EXPECT_EQ(gateway("4 r 0x1018 1"), "read 0x1018:1 -n 4");
  EXPECT_EQ(gateway("1 4 read 4120 10 U32"), "read 0x1018:0Ah --type u32 -n 4");
  EXPECT_EQ(gateway("[12] 1 4 w 0x1017 0 u16 500"), "write 0x1017:0 500 --type u16 -n 4");
  EXPECT_EQ(gateway("4 w 0x6065 0 i32 -5"), "write 0x6065:0 -5 --type i32 -n 4");
  EXPECT_EQ(gateway("4 write 0x2000 0 vs \"two words\""), "write 0x2000:0 \"two words\" --type vs -n 4");
  EXPECT_EQ(gateway("4 r 0x2000 0 r32"), "read 0x2000:0 --type r32 -n 4");
  EXPECT_EQ(gateway("start"), "nmt start");
  EXPECT_EQ(gateway("0 start"), "nmt start -n all");
  EXPECT_EQ(gateway("4 stop"), "nmt stop -n 4");
  EXPECT_EQ(gateway("4 preop"), "nmt preop -n 4");
  EXPECT_EQ(gateway("4 preoperational"), "nmt preop -n 4");
  EXPECT_EQ(gateway("4 reset node"), "nmt reset -n 4");
  EXPECT_EQ(gateway("reset comm"), "nmt reset-comm");
  EXPECT_EQ(gateway("[1] reset communication"), "nmt reset-comm");
  EXPECT_EQ(gateway("set node 4"), "use 4");
  EXPECT_EQ(gateway("[3] set network 1"), "");
}

TEST(GatewayLine, IsToldFromOurOwn) {
  for (const auto* line : {"read 0x1000 0 u32", "write 0x1017 5", "scan", "reset", "nmt start -n 1", "",
                           "start now please x", "status", "set A=5", "use 4"})
    EXPECT_TRUE(gateway(line) == "-" || std::string_view(line).starts_with("start")) << line;
}

TEST(GatewayLine, IsRefusedWhenItIsWrong) {
  for (const auto* line : {"4",
                           "4 5 6 r 0x1000 0",
                           "[1]",
                           "4 r",
                           "4 r 0x1000",
                           "4 r 0x10000 0",
                           "4 r 0x1000 256",
                           "4 r x 0",
                           "4 r 1000h 0",
                           "4 r 0x1000 0 u32 5",
                           "4 w 0x1017 0 500",
                           "4 reset",
                           "4 reset drive",
                           "4 fly",
                           "2 4 start",
                           "set node",
                           "set node x",
                           "set network 2",
                           "4 start 5",
                           "start 5"})
    EXPECT_EQ(gateway(line), "!") << line;
}

TEST(GatewayLine, WorksInABatchFileWithVariables) {
  EXPECT_EQ(said("for N in 4-5\n${N} r 0x1000 0 u32\nend\nset network 1\nset node 4\nr 0x1001 0"),
            (Words{"2 read 0x1000:0 --type u32 -n 4", "2 read 0x1000:0 --type u32 -n 5", "5 use 4",
                   "6 read 0x1001:0"}));
}

}  // namespace
}  // namespace servoctl::cli
