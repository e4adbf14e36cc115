// Simulated drives at the slaves' end of a wire, and a master at the other.
#include "session/serve_ring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <filesystem>

#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const std::filesystem::path kRingFolders[] = {std::filesystem::path(source_dir()) / "eds"};

/// What a master would see, in virtual time: frames of the test go in at their times, and come back.
struct Wire {
  std::deque<std::pair<TimePoint, Bytes>> coming;
  std::vector<Bytes> back;
  TimePoint now{seconds(1)};
  bool link = true;
  bool broken = false;
  std::vector<TimePoint> deadlines;  ///< Of every receive().
};

class WirePort final : public ethernet::Port {
 public:
  explicit WirePort(Wire& wire) : wire_(&wire) {}
  TimePoint now() const override { return wire_->now; }
  Result<void> send(ByteSpan frame) override {
    if (!wire_->link) return fail(Errc::bus, "veth1 has no link");
    wire_->back.emplace_back(frame.begin(), frame.end());
    return {};
  }
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override {
    wire_->deadlines.push_back(deadline);
    if (wire_->broken) return fail(Errc::bus, "veth1 went down");
    if (wire_->coming.empty() || wire_->coming.front().first > deadline) {
      wire_->now = std::max(wire_->now, deadline);
      return std::optional<ByteSpan>();
    }
    wire_->now = std::max(wire_->now, wire_->coming.front().first);
    given_ = wire_->coming.front().second;
    wire_->coming.pop_front();
    return std::optional(ByteSpan(given_));
  }
  Result<void> recover(TimePoint) override { return {}; }
  bool has_link() const override { return wire_->link; }

 private:
  Wire* wire_;
  Bytes given_;
};

/// A broadcast read of the AL states.
Bytes broadcast_read() {
  Bytes frame{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 2,    0, 0, 0, 0, 1, 0x88, 0xA4, 14,
              0x10, 7,    1,    0,    0,    0x30, 0x01, 2, 0, 0, 0, 0, 0,    0,    0};
  frame.resize(60);
  return frame;
}

class RingEndTest : public testing::Test {
 protected:
  void come(Duration at) { wire_.coming.emplace_back(wire_.now + at, broadcast_read()); }
  /// Until all is in, and some more waits have passed.
  Result<void> serve(std::string_view drives) {
    auto cell = sim::build_esc_cell(drives, kRingFolders, wire_.now);
    EXPECT_TRUE(cell) << cell.error().message.text();
    std::size_t idle = 0;
    RingEnd end(std::make_unique<WirePort>(wire_), [&] { return wire_.coming.empty() && ++idle > 3; });
    return end.serve(*cell);
  }
  Wire wire_;
};

TEST_F(RingEndTest, FramesGoBackWithWhatTheSlavesHaveWritten) {
  come(milliseconds(1));
  come(milliseconds(2));
  ASSERT_TRUE(serve("sv2@1,sv2@2"));
  ASSERT_EQ(wire_.back.size(), 2U);
  EXPECT_EQ(wire_.back[0][26], 1);  // INIT
  EXPECT_EQ(wire_.back[1][28], 2);  // Both have read.
}

TEST_F(RingEndTest, AFrameThatNobodyHasFilledUpGoesBackAsLongAsAWireNeedsIt) {
  auto frame = broadcast_read();
  frame.resize(30);
  wire_.coming.emplace_back(wire_.now + milliseconds(1), frame);
  ASSERT_TRUE(serve("sv2@1"));
  ASSERT_EQ(wire_.back.size(), 1U);
  EXPECT_EQ(wire_.back[0].size(), 60U);
  EXPECT_EQ(wire_.back[0][28], 1);
}

TEST_F(RingEndTest, WhatIsPlannedHappensWithoutAFrame) {
  come(milliseconds(1));
  come(seconds(6));
  come(seconds(9));
  const auto cut = wire_.now + seconds(5);
  ASSERT_TRUE(serve("sv2@1,sv2@2?cut=2@5s-8s"));
  EXPECT_GE(std::count(wire_.deadlines.begin(), wire_.deadlines.end(), cut), 1);
  ASSERT_EQ(wire_.back.size(), 3U);
  EXPECT_EQ(wire_.back[0][28], 2);
  EXPECT_EQ(wire_.back[1][28], 1);
  EXPECT_EQ(wire_.back[2][28], 2);
}

TEST_F(RingEndTest, ACableThatIsUnpluggedEndsNothing) {
  wire_.link = false;
  come(milliseconds(1));
  EXPECT_TRUE(serve("sv2@1"));
  EXPECT_TRUE(wire_.back.empty());
}

TEST_F(RingEndTest, AnInterfaceThatIsGoneIsTold) {
  wire_.broken = true;
  const auto served = serve("sv2@1");
  ASSERT_FALSE(served);
  EXPECT_EQ(served.error().message.text(), "veth1 went down");
}

}  // namespace
}  // namespace servoctl::session
