// What answers say of a value that was written, and what a report counts.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/line_runner.hpp"
#include "recording_console.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class Told : public testing::Test {
 protected:
  Told() { fs::create_directories(dir_); }
  ~Told() override { fs::remove_all(dir_); }

  int run(const std::string& family, const std::string& line) {
    console.out_text.clear();
    console.err_text.clear();
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.bus = "sim:" + family + "@1," + family + "@2," + family + "@3";
    options.defaults.drive = family;
    options.defaults.yes = true;
    Shell shell(console, std::move(options));
    return LineRunner(shell).run(line);
  }

  /// The word under a heading of the first row.
  std::string cell(const std::string& heading) const {
    std::istringstream lines(console.out_text);
    std::string head;
    std::string row;
    std::getline(lines, head);
    std::getline(lines, row);
    const auto at = head.find(heading);
    if (at == std::string::npos || at >= row.size()) return {};
    return row.substr(at, row.find("  ", at) - at);
  }

  report::Value report_of(const std::string& tests, int exit = 0) {
    const auto file = dir_ / "report.json";
    EXPECT_EQ(run("gsd600", "report " + file.string() + tests + " -n 1"), exit) << console.err_text;
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return report::parse_json(text.str(), "report").value();
  }

  static std::size_t tests_in(const report::Value& report) {
    const auto& nodes = std::get<report::List>(report::find(report, "nodes")->data());
    return std::get<report::List>(report::find(nodes.front(), "tests")->data()).size();
  }

  fs::path dir_ = fs::temp_directory_path() / ("servoctl-told-" + std::to_string(::getpid()));
  RecordingConsole console;
};

TEST_F(Told, HowASubIndexInDigitsAloneWasReadOnceALine) {
  const std::string ten = "2001:10: the sub-index is read as hexadecimal: 10h, decimal 16\n";
  EXPECT_EQ(run("gsd600", "read 2001:10 2001:10 -n 1,2"), 0);
  EXPECT_EQ(console.err_text, "notice: " + ten);
  EXPECT_EQ(run("gsd600", "write 2001:10 900 -n 1"), 0);
  EXPECT_EQ(console.err_text, "notice: " + ten);
  EXPECT_EQ(run("gsd600", "param set 2001:10=900 -n 1"), 0);
  EXPECT_EQ(console.err_text, "notice: " + ten);
  EXPECT_EQ(run("gsd600", "pdo map TPDO2 2001:10/16 -n 1 --dry-run"), 2);
  EXPECT_EQ(console.err_text.find("notice: " + ten), 0U) << console.err_text;
  EXPECT_EQ(run("gsd600", "read 2001:10h 2001:0x10 2001:F 2001:8 -n 1"), 0);
  EXPECT_EQ(console.err_text, "");
}

TEST_F(Told, OfATestThatEndedWithAnErrorThatItDidNotPass) {
  fs::create_directories(dir_);
  const auto tests = dir_ / "tests.json";
  const std::string comm =
      R"({"test":"comm","node":1,"criteria":[{"id":"lost","name":"lost","verdict":"passed"}]})";
  const auto write = [&](const std::string& code, const std::string& node, int exit) {
    std::ofstream(tests) << R"({"servoctl":1,"command":"test all","ok":false,"error":{"code":")" + code +
                                R"(","exit":8,"message":"no method")" + node + R"(},"result":[)" + comm +
                                "]}";
    const auto told = report_of(" --tests " + tests.string(), exit);
    return tests_in(told);
  };
  EXPECT_EQ(write("negative", "", 1), 2U) << "such as a setting that was not put back";
  EXPECT_EQ(write("refused", R"(,"node":1)", 1), 2U) << "what broke off is told";
  EXPECT_NE(console.out_text.find("FAILED"), std::string::npos) << console.out_text;
  EXPECT_EQ(write("interrupted", "", 1), 2U);
}

TEST_F(Told, OfATestThatCtrlCEndedOnce) {
  fs::create_directories(dir_);
  const auto tests = dir_ / "tests.json";
  const auto write = [&](const std::string& node) {
    std::ofstream(tests)
        << R"({"servoctl":1,"command":"test jog","ok":false,"error":{"code":"interrupted","exit":130,)"
        << R"("message":"node 1: stopped","node":)" + node + R"(},"result":[{"test":"jog","node":1,)"
        << R"("criteria":[{"id":"ended","name":"ended","verdict":"failed"}]}]})";
    return tests_in(report_of(" --tests " + tests.string(), 1));
  };
  // The test of the communication is the report's own.
  EXPECT_EQ(write("1"), 2U) << "the test says itself that it failed";
  EXPECT_EQ(write("null"), 3U) << "of what broke off nothing tells that it is that test";
}

TEST_F(Told, OfAValueWhetherItIsKeptOnEveryFamily) {
  const std::map<std::string, std::string> without_order{{"gsd600", "no"},        {"dm", "no"},
                                                         {"da200", "not stated"}, {"ts", "not stated"},
                                                         {"sv2", "not stated"},   {"cia402", "no"}};
  for (const auto& [family, said] : without_order) {
    EXPECT_EQ(run(family, "write 0x6083 2000 -n 1"), 0) << console.err_text;
    EXPECT_EQ(cell("kept"), said) << family << "\n" << console.out_text;
    if (family == "da200") continue;  // Has no 1010h, and says so.
    EXPECT_EQ(run(family, "write 0x6083 2001 --keep -n 1"), 0) << console.err_text;
    // A switch of the memory is stated for the maker's own parameters.
    EXPECT_EQ(cell("kept"), said == "no" ? "yes" : "not stated") << family << "\n" << console.out_text;
  }
  for (const std::string keep : {"", " --keep"}) {
    EXPECT_EQ(run("ts", "param set Fn_12E=77 -n 1" + keep), 0) << console.err_text;
    EXPECT_EQ(cell("kept"), keep.empty() ? "no" : "yes") << console.out_text;
  }
  EXPECT_EQ(run("ts", "write 0x1017 1000 --keep -n 1"), 0) << console.err_text;
  EXPECT_EQ(cell("kept"), "not stated") << "the switch of the memory is for panel parameters";
}

TEST_F(Told, OneTestOfTheCommunicationInAReport) {
  EXPECT_EQ(tests_in(report_of("")), 1U);
  EXPECT_EQ(run("gsd600", "test comm -n 1 --json"), 0) << console.err_text;
  std::ofstream(dir_ / "comm.json") << console.out_text;
  const auto tests = " --tests " + (dir_ / "comm.json").string();
  const auto once = report_of(tests);
  EXPECT_EQ(tests_in(once), 1U);
  EXPECT_NE(console.out_text.find("1 passed"), std::string::npos) << console.out_text;
  EXPECT_EQ(tests_in(report_of(tests + tests)), 1U) << "the last one is used";
}

TEST_F(Told, CloneTakesRangesOfNodes) {
  EXPECT_EQ(run("dm", "clone --from 1 --to 2-3 --dry-run"), 0) << console.err_text;
  EXPECT_NE(console.out_text.find("node         3"), std::string::npos) << console.out_text;
  EXPECT_EQ(run("dm", "clone --from 1 --to 3-2 --dry-run"), 2);
  EXPECT_EQ(run("dm", "clone --from 2 --to 1-3 --dry-run"), 2) << "it cannot be cloned into itself";
}

TEST_F(Told, ErrorsOfJsonLinesInOneWordAreJson) {
  EXPECT_EQ(run("dm", "read 0x1008 -ojsonl --bogus"), 2);
  EXPECT_TRUE(console.out_text.starts_with("{\"servoctl\":1")) << console.out_text;
}

}  // namespace
}  // namespace servoctl::cli
