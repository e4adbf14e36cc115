// What a report tells of tests that were made before: all that their files tell.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "report_world.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class ReportEarlier : public ReportWorld {
 protected:
  ReportEarlier() : ReportWorld("sim:gsd600@1", "gsd600") {}

  /// The options of a report that name the files of these tests, each of which ends with its exit code.
  std::string tested(const std::vector<std::pair<std::string, int>>& tests) {
    std::string out;
    for (const auto& [test, exit] : tests) {
      EXPECT_EQ(run(test + " --json -y -n 1"), exit) << console.out_text;
      const auto file = dir_ / (std::to_string(files_.size()) + ".json");
      std::ofstream(file) << console.out_text;
      files_.push_back(console.out_text);
      out += " --tests " + file.string();
    }
    return out;
  }

  std::string told(const std::string& name, const std::string& options, int exit) {
    return report(name, options + " -n 1", exit);
  }

  std::vector<std::string> files_;
};

TEST_F(ReportEarlier, TellsInJsonAllThatTheirFilesTell) {
  const auto options = tested({{"test comm", 0},
                               {"test jog 60rpm --turn 131072", 0},
                               {"test home 35 --turn 131072 --encoder 131072 --repeat 3", 0},
                               {"test io --for 100ms", 1}});
  const auto json = report::parse_json(told("report.json", options, 1), "report").value();
  const auto& drive = std::get<report::List>(report::find(json, "nodes")->data()).front();
  const auto& tests = std::get<report::List>(report::find(drive, "tests")->data());
  ASSERT_EQ(tests.size(), files_.size());
  for (std::size_t i = 0; i < files_.size(); ++i) {
    const auto whole = report::parse_json(files_[i], "file").value();
    const auto& written = std::get<report::List>(report::find(whole, "result")->data()).front();
    EXPECT_EQ(report::to_json(tests[i]), report::to_json(written));
  }
}

TEST_F(ReportEarlier, ShowsTheirFiguresOnThePage) {
  const auto options =
      tested({{"test comm", 0}, {"test home 35 --turn 131072 --encoder 131072 --repeat 3", 0}});
  const auto page = told("report.html", options, 0);
  for (const auto* text : {"round trip (ms)", "median", "95 %", "homings", "encoder (deg)"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  const auto chinese = told("chinese.html", options + " --lang zh", 0);
  for (const auto* text : {"往返时间（ms）", "中位数", "编码器（deg）"})
    EXPECT_NE(chinese.find(text), std::string::npos) << text;
}

TEST_F(ReportEarlier, TellsNothingWhereAnOlderFileHasNoFigures) {
  auto options = tested({{"test comm", 0}});
  auto old = files_.front();
  const auto at = old.find(",\"round_trip_ms\"");
  old.erase(at, old.find('}', at) + 1 - at);
  std::ofstream(dir_ / "0.json") << old;
  const auto json = told("report.json", options, 0);
  EXPECT_NE(json.find("\"round_trip_ms\":null"), std::string::npos) << json;
}

TEST_F(ReportEarlier, IsRefusedOfAFileThatIsEmpty) {
  for (const auto* text : {"", "\n \n"}) {
    std::ofstream(dir_ / "empty.json") << text;
    EXPECT_EQ(told("report.json", " --tests " + (dir_ / "empty.json").string(), 7), "");
    EXPECT_NE(console.err_text.find("empty.json contains no test results"), std::string::npos)
        << console.err_text;
  }
}

}  // namespace
}  // namespace servoctl::cli
