// A report of drives of which none answers is an error, and no file.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "report_world.hpp"

namespace servoctl::cli {
namespace {

namespace fs = std::filesystem;

class ReportOfNobody : public ReportWorld {
 protected:
  int report(const std::string& drives) { return run("report " + file().string() + " " + drives); }
  fs::path file() const { return dir_ / "report.html"; }
};

TEST_F(ReportOfNobody, SaysWhoDoesNotAnswerAndWritesNoFile) {
  EXPECT_EQ(report("-b sim:gsd600@1 -d gsd600 -n 9"), 4);
  EXPECT_NE(console.err_text.find("error: node 9: no answer"), std::string::npos) << console.err_text;
  EXPECT_FALSE(fs::exists(file()));
}

TEST_F(ReportOfNobody, OfSeveralBusesSaysItOfTheFirst) {
  std::ofstream(dir_ / "cabinet.toml") << R"([bus.one]
url = "sim:gsd600@1"
[bus.two]
url = "sim:gsd600@2"
[axis.lift]
bus = "one"
node = 8
family = "gsd600"
[axis.turn]
bus = "two"
node = 9
family = "gsd600"
)";
  EXPECT_EQ(report("--cabinet " + (dir_ / "cabinet.toml").string() + " -n lift,turn"), 4);
  EXPECT_NE(console.err_text.find("error: lift: no answer"), std::string::npos) << console.err_text;
  EXPECT_FALSE(fs::exists(file()));
}

}  // namespace
}  // namespace servoctl::cli
