// From a bus to a cabinet file, and what its axes are doing.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../source_dir.hpp"
#include "chinese_words.hpp"
#include "cli/line_runner.hpp"
#include "cli/shell.hpp"
#include "recording_console.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class CabinetInit : public testing::Test {
 protected:
  CabinetInit() : folder(fs::temp_directory_path() / ("servoctl-init-" + std::to_string(::getpid()))) {
    fs::create_directories(folder);
    open();
  }
  ~CabinetInit() override { fs::remove_all(folder); }

  void open() {
    Shell::Options options;
    options.drive_folders = {fs::path(source_dir()) / "eds"};
    options.clock = sim::SimBus::Clock::virtual_time;
    options.defaults.cabinet = file();
    shell = std::make_unique<Shell>(console, options);
    shell->stay_open(true);
  }
  fs::path file() const { return folder / "cabinet.toml"; }
  std::string text() const {
    std::ostringstream out;
    out << std::ifstream(file()).rdbuf();
    return out.str();
  }
  int run(std::string line) {
    for (auto at = line.find("FILE"); at != std::string::npos; at = line.find("FILE"))
      line.replace(at, 4, file().string());
    console.out_text.clear();
    console.err_text.clear();
    return LineRunner(*shell).run(line);
  }
  std::string all() const { return console.out_text + console.err_text; }
  bool says(std::string_view what) const { return all().find(what) != std::string::npos; }

  fs::path folder;
  RecordingConsole console;
  std::unique_ptr<Shell> shell;
};

constexpr const char* kFiveFamilies = "sim:gsd600@1,dm@2,da200@3,ts@4,sv2@5";

TEST_F(CabinetInit, WritesItsCommentsInTheLanguageOfWhoReads) {
  ASSERT_EQ(run(std::string("cabinet init FILE -b ") + kFiveFamilies + " --lang zh"), 0) << all();
  std::istringstream lines(text());
  std::size_t comments = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto at = line.find("# ");
    if (at == std::string::npos) continue;
    const auto note = line.find("# ", at + 1);
    const auto comment = line.substr(note == std::string::npos ? at : note);
    if (comment.find(" = ") != std::string::npos) continue;
    ++comments;
    EXPECT_EQ(english_words(comment), std::vector<std::string>()) << line;
  }
  EXPECT_GT(comments, 15U) << text();
  EXPECT_EQ(run("cabinet check"), 0) << all();
}

TEST_F(CabinetInit, WritesAFileByWhichNothingIsToBeDoneOnAnyFamily) {
  EXPECT_EQ(
      run(std::string("cabinet init FILE --family 1=gsd600,2=dm,3=da200,4=ts,5=sv2 -b ") + kFiveFamilies), 0)
      << all();
  EXPECT_EQ(run("cabinet init FILE --name ring --family 1-2=sv2 -b coe:sim:sv2@1,sv2@2"), 0) << all();
  EXPECT_EQ(run("cabinet check"), 0) << all();
  EXPECT_EQ(run("cabinet plan"), 0) << all() << text();
  for (const auto* name : {"node1", "node5", "slave1", "slave2"}) EXPECT_TRUE(says(name)) << name << all();
}

/// As many as a cabinet has, on two wires.
TEST_F(CabinetInit, FortyAxesOfFiveFamiliesOnTwoBusesPlanEmpty) {
  constexpr std::array kFamilies{"gsd600", "dm", "da200", "ts"};
  std::string drives;
  std::string families;
  for (std::size_t node = 1; node <= 32; ++node) {
    const auto* family = kFamilies[node % kFamilies.size()];
    drives += fmt::format("{}{}@{}", node == 1 ? "" : ",", family, node);
    families += fmt::format("{}{}={}", node == 1 ? "" : ",", node, family);
  }
  EXPECT_EQ(run(fmt::format("cabinet init FILE --family {} -b sim:{}", families, drives)), 0) << all();
  std::string ring;
  for (int slave = 1; slave <= 8; ++slave) ring += fmt::format("{}sv2@{}", slave == 1 ? "" : ",", slave);
  EXPECT_EQ(run("cabinet init FILE --name ring --family 1-8=sv2 -b coe:sim:" + ring), 0) << all();
  EXPECT_EQ(run("cabinet check"), 0) << all();
  EXPECT_EQ(run("cabinet plan --json"), 0) << all();
  std::size_t axes = 0;
  for (auto at = all().find("\"axis\":"); at != std::string::npos; at = all().find("\"axis\":", at + 1))
    ++axes;
  EXPECT_GE(axes, 40U) << all();
}

TEST_F(CabinetInit, TakesWhatIsNotAsFromTheFactory) {
  const std::string bus = " -b sim:gsd600@1,gsd600@2 ";
  EXPECT_EQ(run("param set Pn0202=500 -n 1 -d gsd600 --yes" + bus), 0) << all();
  EXPECT_EQ(run("write 0x1017 250 -n 2 -d gsd600 --yes" + bus), 0) << all();
  EXPECT_EQ(run("cabinet init FILE --family 1-2=gsd600" + bus), 0) << all();
  EXPECT_NE(text().find("\nPn0202 = 500  # Position loop gain 1\n"), std::string::npos) << text();
  EXPECT_NE(text().find("heartbeat = \"250ms\"\n"), std::string::npos) << text();
  EXPECT_EQ(run("cabinet check"), 0) << all();
}

TEST_F(CabinetInit, MarksWhatItGuesses) {
  EXPECT_EQ(run("cabinet init FILE -b sim:da200@1"), 0) << all();
  EXPECT_NE(text().find("family = \"da200\"  # guessed by its identity"), std::string::npos) << text();
  EXPECT_TRUE(says("node 1: its identity fits da200 (a guess, not proof)")) << all();
  EXPECT_EQ(run("cabinet init FILE -b sim:da200@1"), 8) << all();
  EXPECT_TRUE(says("has bus main (sim:da200@1) already")) << all();
}

TEST_F(CabinetInit, RefusesWhatItCannotBeToldAndWritesNothing) {
  EXPECT_EQ(run("cabinet init FILE --family 1 -b sim:da200@1"), 2) << all();
  EXPECT_TRUE(says("--family: '1' names no family")) << all();
  EXPECT_EQ(run("cabinet init FILE -n 9 -b sim:da200@1 --timeout 50ms --retries 0"), 4) << all();
  EXPECT_TRUE(says("no node answers")) << all();
  EXPECT_EQ(run("cabinet init FILE --family x=da200 -b sim:da200@1"), 2) << all();
  EXPECT_EQ(run("cabinet init FILE --name all -b sim:da200@1"), 2) << all();
  EXPECT_TRUE(says("'all' cannot be the name of a bus")) << all();
  EXPECT_EQ(run("cabinet init FILE --family 1=nofam -b sim:da200@1"), 2) << all();
  EXPECT_EQ(run("cabinet init FILE --dry-run -b sim:da200@1"), 0) << all();
  EXPECT_FALSE(fs::exists(file()));
  std::ofstream(file()) << "[bus.main]\nurl = 1\n";
  EXPECT_EQ(run("cabinet init FILE -b sim:da200@1"), 7) << all();
  EXPECT_EQ(text(), "[bus.main]\nurl = 1\n");
}

TEST_F(CabinetInit, ShowHasALineForEachAxisAndTellsWhatIsNotReached) {
  std::ofstream(file()) << R"([bus.main]
url = "sim:gsd600@1"
[bus.gone]
url = "local:servoctl-nobody-is-here"
[axis.feeder]
bus = "main"
node = 1
family = "gsd600"
turn = 10000
per_turn = "5 mm"
[axis.away]
bus = "main"
node = 9
family = "ts"
)";
  EXPECT_EQ(run("move feeder 20mm --yes"), 0) << all();
  EXPECT_EQ(run("cabinet show --json --retries 0 --timeout 50ms"), 4) << all();
  EXPECT_TRUE(says(R"("axis":"feeder","bus":"main","node":1,"family":"gsd600")")) << all();
  EXPECT_TRUE(says(R"("position":{"value":20,"unit":"mm"})")) << all();
  EXPECT_TRUE(says(R"("axis":"away")") && says(R"("message":"away, object 0x6041:0: no answer)")) << all();
  EXPECT_EQ(run("cabinet show feeder"), 0) << all();
  EXPECT_FALSE(says("away")) << all();
  EXPECT_EQ(run("cabinet show nobody"), 2) << all();
}

/// What has to be seen to before an apply: the manuals' "effective at standstill", and what is behind a
/// password.
TEST_F(CabinetInit, APlanTellsWhatItNeeds) {
  std::ofstream(file()) << R"([bus.main]
url = "sim:da200@1,ts@2"
[axis.a]
node = 1
family = "da200"
[axis.a.parameters]
"P0.26" = 2
[axis.b]
node = 2
family = "ts"
[axis.b.parameters]
Fn_00 = 5
)";
  EXPECT_EQ(run("cabinet plan --json"), 1) << all();
  EXPECT_TRUE(says(R"({"need":"standstill","parameters":["P0.26"]})")) << all();
  EXPECT_TRUE(says(R"({"need":"password","parameters":["Fn_00"]})")) << all();
  EXPECT_EQ(run("cabinet plan"), 1) << all();
  EXPECT_TRUE(says("needs standstill (P0.26)") && says("needs the password: --unlock (Fn_00)")) << all();
}

TEST_F(CabinetInit, ShowWatchesWithALineForEachChange) {
  std::ofstream(file())
      << "[bus.main]\nurl = \"sim:gsd600@1\"\n[axis.feeder]\nnode = 1\nfamily = \"gsd600\"\n";
  EXPECT_EQ(run("cabinet show --watch --for 600ms -o jsonl"), 0) << all();
  std::size_t lines = 0;
  for (auto at = console.out_text.find("\"time\":"); at != std::string::npos;
       at = console.out_text.find("\"time\":", at + 1))
    ++lines;
  EXPECT_EQ(lines, 1U) << all();  // Nothing changed after the first look.
}

}  // namespace
}  // namespace servoctl::cli
