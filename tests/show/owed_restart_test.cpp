// What is kept of a drive that waits for a restart, where no restart was heard: the drive itself says whether
// it is over.
#include "show/owed_restart.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
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
    ASSERT_TRUE(bus) << bus.error().message.text();
    session = std::make_unique<session::Session>(std::move(*bus), url, session::Options{});
  }
  static OwedRestart owed(session::OwedValue value, std::uint32_t serial = 0) {
    OwedRestart out;
    out.identity.node = 1;
    out.identity.serial = serial;
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

TEST_F(OwedRestartKept, TheFolderSaysOfWhichNodes) {
  EXPECT_TRUE(owing_nodes(folder / "none", "sim:one").empty());
  for (const auto* url : {"sim:one", "sim:one-node-1", "sim:other"})
    for (const auto node : {std::uint8_t{127}, std::uint8_t{1}})
      ASSERT_TRUE(
          OwedRestartFile(folder, url, node).write(owed({{0x2003, 2}, Bytes{0, 0}, Bytes{1, 0}, true})));
  for (const auto* name : {"restart-sim-one-node-0.json", "restart-sim-one-node-1.json.part", "other"})
    std::ofstream(folder / name) << "{}";
  for (const auto* url : {"sim:one", "sim:one-node-1", "sim:other"})
    EXPECT_EQ(owing_nodes(folder, url), (std::vector<std::uint8_t>{1, 127})) << url;
}

/// A drive of the kind at the node-ID that waits may be another one, unless its serial number is the same.
TEST_F(OwedRestartKept, IsOverWhereTheSameDriveAnswersWithItsNewNodeId) {
  for (const auto serial : {0U, 1U}) {
    open(serial == 0 ? "gsd600@5" : "gsd600@5?lss", "sim:one");
    ASSERT_TRUE(file().write(owed({kNodeIdParameter, Bytes{1, 0}, Bytes{5, 0}, true}, serial)));
    EXPECT_EQ(waits(), serial == 0);
    EXPECT_EQ(file().is_there(), serial == 0);
  }
}

/// Somebody else may have written it.
TEST_F(OwedRestartKept, AnotherNodeIdInItsMemoryEndsNothingElse) {
  open("gsd600@1", "sim:one");
  auto kept = owed({kNodeIdParameter, Bytes{1, 0}, Bytes{5, 0}, true});
  kept.values.push_back({{0x2003, 2}, Bytes{0, 0}, Bytes{1, 0}, true});
  ASSERT_TRUE(file().write(kept));
  const auto waiting = owed_restart(*session, folder, 1).values;
  ASSERT_EQ(waiting.size(), 1U);
  EXPECT_EQ(waiting.front().object, (ObjectAddress{0x2003, 2})) << "its Pn0601 is 1 as delivered";
  EXPECT_TRUE(file().is_there());
}

TEST_F(OwedRestartKept, AnotherDriveAtTheNodeOwesNothingAndItsOwnMayComeBack) {
  open("gsd600@1?lss", "sim:one");
  ASSERT_TRUE(file().write(owed({{0x2003, 2}, Bytes{0, 0}, Bytes{1, 0}, true}, 4711)));
  EXPECT_FALSE(waits());
  EXPECT_TRUE(file().is_there());
}

TEST_F(OwedRestartKept, StaysWhereNobodyAnswersOrAnotherKindDoes) {
  open("dm@5", "sim:one");
  ASSERT_TRUE(file().write(owed({kNodeIdParameter, Bytes{1, 0}, Bytes{5, 0}, true})));
  EXPECT_TRUE(waits());
  open("gsd600@7", "sim:one");
  EXPECT_TRUE(waits());
}

/// A drive that starts at the node-ID that waits may be any, where nothing is known of the one that is kept.
TEST_F(OwedRestartKept, AStartAtTheNewNodeIdCountsOnlyOfAKnownKind) {
  open("gsd600@5", "sim:one");
  auto kept = owed({kNodeIdParameter, Bytes{1, 0}, Bytes{5, 0}, true});
  EXPECT_EQ(owing(*session, 1, kept, true), Owing::over);
  kept.identity.device_type.reset();
  EXPECT_EQ(owing(*session, 1, kept, true), Owing::waits);
}

TEST_F(OwedRestartKept, IsOverWhereTheSameDriveAnswersAtItsNewBitrate) {
  struct Case {
    std::uint32_t bitrate;
    std::uint32_t serial;
    bool is_over;
  };
  for (const auto& [bitrate, serial, is_over] :
       {Case{1'000'000, 1, false}, Case{500'000, 0, false}, Case{500'000, 1, true}}) {
    open(serial == 0 ? "gsd600@1" : "gsd600@1?lss", "slcan:/dev/ttyNone@1M");
    auto kept = owed({kBitrateParameter, Bytes{6, 0}, Bytes{8, 0}, true}, serial);
    kept.bus_bitrate = bitrate;
    ASSERT_TRUE(OwedRestartFile(folder, "slcan:/dev/ttyNone@500k", 1).write(kept));
    EXPECT_EQ(waits(), !is_over) << bitrate << " " << serial;
    EXPECT_EQ(file().is_there(), !is_over) << bitrate << " " << serial;
  }
}

}  // namespace
}  // namespace servoctl::show
