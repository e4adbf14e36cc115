// CAN FD frames on the bus: they are counted, and no silence.
#include <gtest/gtest.h>

#include "report/value.hpp"
#include "tested_drive.hpp"

namespace servoctl::commands {
namespace {

class FdFrames : public TestedDrive {
 protected:
  FdFrames() { build("gsd600@1", "gsd600"); }
  /// From the first look of the command on, seven have come; three before it.
  void seven_come() {
    bus->came_of_fd = [asked = 0]() mutable { return std::uint64_t{asked++ == 0 ? 3U : 10U}; };
  }
  bool is_noticed(std::string_view text) const {
    for (const auto& notice : context.notices)
      if (notice.text().find(text) != std::string::npos) return true;
    return false;
  }
};

TEST_F(FdFrames, AreCountedByMonitor) {
  seven_come();
  const auto result = run("monitor", {{"--for", "100ms"}});
  ASSERT_TRUE(result) << result.error().message.text();
  EXPECT_NE(report::to_json(*result).find(R"("fd_frames":7)"), std::string::npos) << report::to_json(*result);
}

TEST_F(FdFrames, AreWhyPdoWatchSawNoPdo) {
  seven_come();
  const auto result = run("pdo watch", {{"--for", "100ms"}});
  ASSERT_TRUE(result) << result.error().message.text();
  EXPECT_NE(report::to_json(*result).find(R"("fd_frames":7)"), std::string::npos) << report::to_json(*result);
  EXPECT_TRUE(is_noticed("CAN FD frames that came and were not read: 7"));
  EXPECT_FALSE(is_noticed("no PDO came: nodes send them"));
}

TEST_F(FdFrames, AreNotNamedWhereNoneCame) {
  ASSERT_TRUE(run("pdo watch", {{"--for", "100ms"}}));
  EXPECT_TRUE(is_noticed("no PDO came: nodes send them"));
  const auto result = run("monitor", {{"--for", "100ms"}});
  ASSERT_TRUE(result);
  EXPECT_NE(report::to_json(*result).find(R"("fd_frames":0)"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::commands
