#include "session/bitrate_scan.hpp"

#include <gtest/gtest.h>

#include "tests/session/fake_link.hpp"

namespace servoctl::session {
namespace {

/// A bus on which node 3 answers every read of 1000h, at one bitrate; every other read it refuses.
class TunedBus final : public can::Bus {
 public:
  TunedBus(FakeLink& link, std::uint32_t bitrate) : link_(&link), bitrate_(bitrate) {}

  TimePoint now() const override { return link_->clock; }
  Result<void> send(const can::Frame& frame) override {
    if (!link_->now.up) return fail(Errc::bus, "can0 went down");
    if (link_->now.bitrate != bitrate_ || frame.id != 0x603) return {};
    answer_ = frame;
    answer_->id = 0x583;
    const bool type = frame.data[1] == 0x00 && frame.data[2] == 0x10;
    answer_->data[0] = type ? 0x43 : 0x80;
    if (type)
      answer_->data[4] = 0x92;
    else
      std::copy_n(std::array<std::uint8_t, 4>{0x00, 0x00, 0x02, 0x06}.begin(), 4, answer_->data.begin() + 4);
    return {};
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (answer_) return std::exchange(answer_, std::nullopt);
    link_->clock = std::max(link_->clock, deadline);
    return std::optional<can::Frame>();
  }
  Result<void> recover(TimePoint) override {
    ++recovered;
    return {};
  }

  int recovered = 0;

 private:
  FakeLink* link_;
  std::uint32_t bitrate_;
  std::optional<can::Frame> answer_;
};

struct Scanned {
  explicit Scanned(std::uint32_t bitrate) : link(controller(true, 1'000'000)) {
    auto bus = std::make_unique<TunedBus>(link, bitrate);
    session = std::make_unique<Session>(std::move(bus), "can0", Options{});
  }
  Result<BitrateScan> run(std::vector<std::uint32_t> bitrates) {
    const std::vector<std::uint8_t> nodes{1, 2, 3};
    return scan_bitrates(*session, link, nodes, bitrates, {}, before_details);
  }
  BeforeDetails before_details;
  FakeLink link;
  std::unique_ptr<Session> session;
};

TEST(BitrateScan, LeavesTheInterfaceWhereNodesAnswered) {
  Scanned scanned(250'000);
  const auto done = scanned.run({500'000, 250'000, 125'000});
  ASSERT_TRUE(done.has_value()) << done.error().message.text();
  EXPECT_EQ(done->bitrate, 250'000U);
  ASSERT_EQ(done->found.size(), 1U);
  EXPECT_EQ(done->found[0].node, 3);
  ASSERT_EQ(done->asked.size(), 2U);
  EXPECT_EQ(done->asked[0].nodes, 0U);
  EXPECT_EQ(scanned.link.now.bitrate, 250'000U);
  EXPECT_TRUE(scanned.link.now.up);
}

TEST(BitrateScan, TellsWhoAnsweredBeforeItReadsMore) {
  Scanned scanned(250'000);
  std::vector<std::uint8_t> told;
  scanned.before_details = [&](std::span<const Identity> found) {
    for (const auto& identity : found) told.push_back(identity.node);
  };
  ASSERT_TRUE(scanned.run({500'000, 250'000}).has_value());
  EXPECT_EQ(told, (std::vector<std::uint8_t>{3}));
}

TEST(BitrateScan, PutsTheInterfaceBackWhereNobodyAnswered) {
  Scanned scanned(20'000);
  const auto done = scanned.run({500'000, 250'000});
  ASSERT_TRUE(done.has_value());
  EXPECT_FALSE(done->bitrate.has_value());
  EXPECT_EQ(scanned.link.now.bitrate, 1'000'000U);
  EXPECT_TRUE(scanned.link.now.up);
}

TEST(BitrateScan, PutsTheInterfaceBackWhenItIsCancelled) {
  Scanned scanned(20'000);
  int left = 3;
  scanned.session->options().cancelled = [&] { return --left < 0; };
  EXPECT_EQ(scanned.run({500'000, 250'000, 125'000}).error().code, Errc::interrupted);
  EXPECT_EQ(scanned.link.now.bitrate, 1'000'000U);
  EXPECT_TRUE(scanned.link.now.up);
}

TEST(BitrateScan, IsRefusedWhereSomebodyTalks) {
  FakeLink link(controller(true));
  EXPECT_TRUE(hold_silence(link, std::chrono::seconds(1), {}).has_value());
  can::Frame heartbeat;
  heartbeat.id = 0x701;
  heartbeat.size = 1;
  link.on_wire[500'000] = {heartbeat};
  const auto used = hold_silence(link, std::chrono::seconds(1), {});
  EXPECT_EQ(used.error().code, Errc::refused);
  EXPECT_EQ(used.error().message.text(), "can0 is in use: 1 frame was heard at 500 kbit/s");
  can::Frame stuff;
  stuff.error = true;
  stuff.id = 0x088;
  stuff.size = 8;
  stuff.data[2] = 0x04;
  link.on_wire[500'000] = {stuff};
  const auto noise = hold_silence(link, std::chrono::seconds(1), {});
  EXPECT_EQ(noise.error().code, Errc::refused);
  EXPECT_NE(noise.error().hint.text().find("bus detect can0"), std::string::npos);
}

}  // namespace
}  // namespace servoctl::session
