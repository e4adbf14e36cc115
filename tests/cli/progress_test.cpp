#include "cli/terminal/progress.hpp"

#include <gtest/gtest.h>

#include "recording_console.hpp"

namespace servoctl::cli {
namespace {

using namespace std::chrono_literals;

TEST(Progress, SpeaksAfterAWhileTenTimesASecondAndWipesItsLine) {
  RecordingConsole console;
  Progress progress(console);
  const TimePoint begin{5s};
  progress.update(0, 1000, begin);
  progress.update(100, 1000, begin + 299ms);
  EXPECT_TRUE(console.progress.empty());
  progress.update(250, 1000, begin + 500ms);
  progress.update(300, 1000, begin + 599ms);
  progress.update(1000, 1000, begin + 1000ms);
  progress.end();
  EXPECT_EQ(console.progress,
            (std::vector<std::string>{"[#######.......................]  25% of 1000 bytes, 0.5 kB/s",
                                      "[##############################] 100% of 1000 bytes, 1.0 kB/s", ""}));
}

TEST(Progress, KnowsNoShareOfAnUnknownWhole) {
  RecordingConsole console;
  Progress progress(console);
  progress.update(0, {}, TimePoint{5s});
  progress.update(2000, {}, TimePoint{6s});
  EXPECT_EQ(console.progress, std::vector<std::string>{"2000 bytes, 2.0 kB/s"});
}

TEST(Progress, CountsTheObjectsOfALongList) {
  RecordingConsole console;
  Progress progress(console);
  progress.update_list(1, 400, TimePoint{5s});
  progress.update_list(100, 400, TimePoint{6s});
  EXPECT_EQ(console.progress,
            std::vector<std::string>{"[#######.......................]  25% of 400 objects"});
}

TEST(Progress, IsSilentAboutWhatIsQuick) {
  RecordingConsole console;
  Progress progress(console);
  progress.update(10, 20, TimePoint{5s});
  progress.end();
  EXPECT_TRUE(console.progress.empty());
}

}  // namespace
}  // namespace servoctl::cli
