// Words, settings and completion.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "base/text.hpp"
#include "cli/line_runner.hpp"
#include "cli/terminal/completer.hpp"
#include "cli/words.hpp"
#include "recording_console.hpp"
#include "session/can_network.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

using Words = std::vector<std::string>;

TEST(Words, AreSplitAsAShellDoes) {
  EXPECT_EQ(split_words("write  0x2000 -5").value(), (Words{"write", "0x2000", "-5"}));
  EXPECT_EQ(split_words(R"(write x "two words" 'a "b"' c\ d e"f g"h)").value(),
            (Words{"write", "x", "two words", "a \"b\"", "c d", "ef gh"}));
  EXPECT_EQ(split_words(R"(a "" '')").value(), (Words{"a", "", ""}));
  EXPECT_EQ(split_words("read x # a comment").value(), (Words{"read", "x"}));
  EXPECT_EQ(split_words("a#b").value(), Words{"a#b"});
  EXPECT_EQ(split_words("# nothing").value(), Words{});
  EXPECT_FALSE(split_words("a 'b"));
  EXPECT_FALSE(split_words("a \"b"));
}

TEST(Nodes, AreListsAndRanges) {
  using Nodes = std::vector<std::uint8_t>;
  EXPECT_EQ(parse_nodes("1").value(), Nodes{1});
  EXPECT_EQ(parse_nodes("5-8,1,3,6").value(), (Nodes{1, 3, 5, 6, 7, 8}));
  EXPECT_EQ(parse_nodes("0x10").value(), Nodes{16});
  EXPECT_EQ(parse_nodes("ALL").value(), Nodes{0});
  EXPECT_EQ(parse_nodes("1-127").value().size(), 127U);
  for (const auto* text : {"", "0", "128", "8-5", "1,,2", "-1", "a", "1-", "1-2-3"})
    EXPECT_FALSE(parse_nodes(text)) << text;
}

std::vector<std::string> offered_words(std::string_view line, Shell& shell) {
  std::vector<std::string> out;
  for (const auto& one : complete(line, shell).candidates) out.push_back(one.word);
  return out;
}

class ShellTest : public testing::Test {
 protected:
  ShellTest() : shell(console, options()) {}
  static Shell::Options options() {
    Shell::Options o;
    o.drive_folders = {std::filesystem::path(source_dir()) / "eds"};
    o.clock = sim::SimBus::Clock::virtual_time;
    o.defaults.bus = "sim:gsd600@1";
    o.defaults.drive = "gsd600";
    return o;
  }
  int run(std::string_view line) {
    console.out_text.clear();
    console.err_text.clear();
    return LineRunner(shell).run(line);
  }
  std::vector<std::string> words(std::string_view line) { return offered_words(line, shell); }
  bool offers(std::string_view line, std::string_view word) {
    const auto offered = words(line);
    return std::find(offered.begin(), offered.end(), word) != offered.end();
  }
  RecordingConsole console;
  Shell shell;
};

TEST_F(ShellTest, CompletesCommandsOptionsNamesAndNumbers) {
  EXPECT_TRUE(offers("", "scan"));
  EXPECT_TRUE(offers("", "use"));
  EXPECT_TRUE(offers("pa", "param"));
  EXPECT_FALSE(offers("pa", "scan"));
  EXPECT_TRUE(offers("param ", "search"));
  EXPECT_TRUE(offers("param get pn02", "Pn0202"));
  EXPECT_TRUE(offers("param get Pn0202 pn02", "Pn0203"));
  EXPECT_TRUE(offers("read stat", "statusword"));
  EXPECT_TRUE(offers("read -n 1 stat", "statusword"));
  EXPECT_TRUE(offers("read --ty", "--type"));
  EXPECT_TRUE(offers("read x --type u", "u16"));
  EXPECT_TRUE(offers("drive ", "gsd600"));
  EXPECT_TRUE(offers("-d ", "gsd600"));
  EXPECT_TRUE(offers("bus ", "local:"));
  EXPECT_TRUE(offers("bus co", "coe:local:"));
  EXPECT_TRUE(words("param get zz").empty());
}

TEST(Completer, OffersTopicsWordByWord) {
  RecordingConsole console;
  Shell::Options options;
  options.drive_folders = {std::filesystem::path(source_dir()) / "tests/cli/data/explain"};
  Shell shell(console, std::move(options));
  EXPECT_EQ(offered_words("explain ", shell),
            (std::vector<std::string>{"pp", "homing", "cable", "exit", "AL"}));
  EXPECT_EQ(offered_words("explain Homing ", shell), std::vector<std::string>{"method"});
  EXPECT_EQ(offered_words("explain -d x1 DI ", shell), std::vector<std::string>{"functions"});
  EXPECT_EQ(offered_words("explain -d x1 c", shell), (std::vector<std::string>{"CN3", "cable"}));
  EXPECT_EQ(offered_words("explain -d x1 stat", shell), std::vector<std::string>{"statusword"});
}

TEST_F(ShellTest, AsksBeforeAResetAndSendsNothingWhenTheAnswerIsNo) {
  console.person = true;
  EXPECT_EQ(shell.run({"nmt", "reset", "-n", "1"}), 8);
  ASSERT_EQ(console.questions.size(), 1U);
  EXPECT_NE(console.questions[0].find("Reset node 1?"), std::string::npos);
  console.answer = true;
  EXPECT_EQ(shell.run({"nmt", "reset", "-n", "1", "--wait"}), 0);
  EXPECT_NE(console.err_text.find("notice: node 1: boot-up"), std::string::npos);
}

TEST_F(ShellTest, TellsEmergenciesThatComeWhileACommandRuns) {
  EXPECT_EQ(shell.run({"read", "0x6041", "-n", "9", "--bus", "sim:gsd600@1?fault=0xFF00@100ms"}), 4);
  EXPECT_NE(console.err_text.find("notice: node 1: EMCY 0xFF00 Servo alarm"), std::string::npos)
      << console.err_text;
}

TEST_F(ShellTest, TellsATraceThatCannotBeWrittenAndDoesWhatItWasAskedFor) {
  // A short line is told of when its last frames are written, a long one while it runs.
  EXPECT_EQ(run("read 0x6041 -n 1 --trace /dev/full"), 7);
  EXPECT_NE(console.out_text.find("0x6041"), std::string::npos) << console.out_text;
  EXPECT_NE(console.err_text.find("error: cannot write the trace /dev/full: No space left on device\n"
                                  "  hint: the trace ends here; the command continues without it\n"),
            std::string::npos)
      << console.err_text;
  EXPECT_EQ(run("read 0x6041 -n 1 --trace /dev/full"), 0) << "the command continues without it";
  EXPECT_EQ(run("watch 0x6041 -n 1 --for 1s --trace /dev/full -b sim:gsd600@1,gsd600@2"), 7);
  EXPECT_NE(console.err_text.find("notice: cannot write the trace"), std::string::npos) << console.err_text;
  EXPECT_GE(std::count(console.out_text.begin(), console.out_text.end(), '\n'), 10) << "it watched on";
}

TEST_F(ShellTest, EndsWithExitSevenWhenTheTraceFailsAtTheVeryEnd) {
  for (const auto& [code, in_the_end] : {std::pair(0, 7), std::pair(5, 5)}) {
    console.err_text.clear();
    shell.defaults().trace = "/dev/full";
    const auto session = shell.open(shell.defaults());
    ASSERT_TRUE(session);
    ASSERT_TRUE((*session)->can()->send(*can::parse_frame("000#0101")));
    EXPECT_EQ(shell.close(code), in_the_end);
    EXPECT_NE(console.err_text.find("cannot write the trace /dev/full"), std::string::npos);
  }
  shell.defaults().trace.clear();
  ASSERT_TRUE(shell.open(shell.defaults()));
  EXPECT_EQ(shell.close(0), 0);
}

TEST_F(ShellTest, RunsTheLinesOfAFileToTheirEndWithoutATraceThatFails) {
  shell.stay_open(true);
  EXPECT_EQ(run("read 0x6041 -n 1 --trace /dev/full"), 0);
  EXPECT_NE(console.err_text.find("notice: cannot write the trace /dev/full"), std::string::npos)
      << console.err_text;
  EXPECT_EQ(run("read 0x6041 -n 1 --trace /dev/full"), 0);
  EXPECT_EQ(console.err_text, "");
  EXPECT_EQ(shell.close(0), 7);
}

TEST_F(ShellTest, KeepsTheBusOpenHoweverItsInterfaceIsWritten) {
  EXPECT_EQ(session::canonical_url("socketcan:can0"), "can0");
  EXPECT_EQ(session::canonical_url("can0"), "can0");
  EXPECT_EQ(session::canonical_url("local:socketcan"), "local:socketcan");
}

TEST_F(ShellTest, KeepsTheBusOpenBetweenLines) {
  EXPECT_EQ(shell.run({"param", "set", "Pn0214", "450", "-n", "1"}), 0);
  const auto* session = shell.session();
  EXPECT_EQ(shell.run({"param", "get", "Pn0214", "-n", "1"}), 0);
  EXPECT_EQ(shell.session(), session);
  EXPECT_NE(console.out_text.find("450 = 45 Hz"), std::string::npos);
}

TEST_F(ShellTest, FitsItsTextIntoEightyColumns) {
  console.columns = 80;
  for (const Words& words :
       {Words{"scan"}, Words{"param", "list"}, Words{"objects"}, Words{"fault", "list"},
        Words{"status", "-n", "1"}, Words{"param", "explain", "Pn0030"},
        Words{"param", "get", "Pn02*", "-n", "1"}, Words{"param", "list", "--lang", "zh"}}) {
    console.out_text.clear();
    EXPECT_EQ(shell.run(words), 0);
    for (const auto line : split(std::string_view(console.out_text), '\n'))
      EXPECT_LE(display_width(line), 80U) << line;
  }
}

TEST_F(ShellTest, WritesNothingWhenOneOfSeveralValuesIsWrong) {
  EXPECT_EQ(shell.run({"param", "set", "Pn0214=450", "Pn0215=99999", "-n", "1"}), 2);
  console.out_text.clear();
  EXPECT_EQ(shell.run({"param", "get", "Pn0214", "-n", "1"}), 0);
  EXPECT_NE(console.out_text.find("600 = 60 Hz"), std::string::npos) << console.out_text;
}

TEST_F(ShellTest, SendsNothingInADryRun) {
  EXPECT_EQ(shell.run({"param", "set", "Pn0214", "450", "-n", "1", "--dry-run"}), 0);
  EXPECT_NE(console.out_text.find("601#2B01200FC2010000"), std::string::npos) << console.out_text;
  console.out_text.clear();
  EXPECT_EQ(shell.run({"param", "get", "Pn0214", "-n", "1"}), 0);
  EXPECT_NE(console.out_text.find("600 = 60 Hz"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::cli
