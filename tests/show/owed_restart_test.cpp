// What is kept of a drive that waits for a restart, where no restart was heard: the drive itself says whether
// it is over.
#include "show/owed_restart.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "session/session.hpp"
#include "sim/cell.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::show {
namespace {

namespace fs = std::filesystem;

constexpr ObjectAddress kNodeIdParameter{0x2000, 0x32};
constexpr ObjectAddress kBitrateParameter{0x2000, 0x31};
constexpr std::uint32_t kDeviceType = 0x0002'0192;

class OwedRestartKept : public testing::Test {
 protected:
  OwedRestartKept() { fs::create_directories(folder); }
  ~OwedRestartKept() override { fs::remove_all(folder); }

  /// A gsd600 as delivered, at this node of a bus with this URL.
  void open(std::string_view spec, const std::string& url) {
    auto bus = sim::open_sim(spec, folders, sim::SimBus::Clock::virtual_time);
    ASSERT_TRUE(bus) << bus.error().message;
    session = std::make_unique<session::Session>(std::move(*bus), url, session::Options{});
  }
  static OwedRestart owed(session::OwedValue value) {
    OwedRestart out;
    out.identity.node = 1;
    out.identity.device_type = kDeviceType;
    out.values.push_back(std::move(value));
    out.node_id = kNodeIdParameter;
    return out;
  }
  OwedRestartFile file() const { return {folder, session->url(), 1}; }
  bool waits() { return !owed_restart(*session, folder, 1).values.empty(); }

  const std::vector<fs::path> folders{fs::path(source_dir()) / "eds"};
  const fs::path folder = fs::path(testing::TempDir()) / (std::to_string(::getpid()) + "-owed");
  std::unique_ptr<session::Session> session;
};

/// Without a serial number the kind alone is known; that it holds another node-ID shows that it is another.
TEST_F(OwedRestartKept, IsNotOfADriveThatLaterHasTheOldNodeId) {
  open("gsd600@1", "sim:one");
  auto kept = owed({kNodeIdParameter, Bytes{1, 0}, Bytes{5, 0}, true});
  kept.values.push_back({{0x2003, 2}, Bytes{0, 0}, Bytes{1, 0}, true});
  ASSERT_TRUE(file().write(kept));
  EXPECT_FALSE(waits()) << "its Pn0601 is 1 as delivered";
  EXPECT_FALSE(file().is_there());
}

TEST_F(OwedRestartKept, IsOverWhereTheDriveAnswersWithItsNewNodeId) {
  open("gsd600@5", "sim:one");
  ASSERT_TRUE(file().write(owed({kNodeIdParameter, Bytes{1, 0}, Bytes{5, 0}, true})));
  EXPECT_FALSE(waits());
  EXPECT_FALSE(file().is_there());
}

TEST_F(OwedRestartKept, StaysWhereNobodyAnswersOrAnotherKindDoes) {
  open("dm@5", "sim:one");
  ASSERT_TRUE(file().write(owed({kNodeIdParameter, Bytes{1, 0}, Bytes{5, 0}, true})));
  EXPECT_TRUE(waits());
  open("gsd600@7", "sim:one");
  EXPECT_TRUE(waits());
}

TEST_F(OwedRestartKept, IsOverWhereTheDriveAnswersAtItsNewBitrate) {
  for (const auto& [bitrate, is_over] : {std::pair{1'000'000U, false}, std::pair{500'000U, true}}) {
    open("gsd600@1", "slcan:/dev/ttyNone@1M");
    // As delivered: the code of 1 Mbit/s.
    auto kept = owed({kBitrateParameter, Bytes{6, 0}, Bytes{8, 0}, true});
    kept.bus_bitrate = bitrate;
    ASSERT_TRUE(file().write(kept));
    EXPECT_EQ(waits(), !is_over) << bitrate;
    EXPECT_EQ(file().is_there(), !is_over) << bitrate;
  }
}

}  // namespace
}  // namespace servoctl::show
