// A server whose answers all come twice, the second one up to 50 ms later: nothing of that is an error, and
// no value is an older one.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <utility>

#include "canopen/sdo_client.hpp"
#include "one_object.hpp"
#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

constexpr ObjectAddress kObject{0x2000, 1};
constexpr ObjectAddress kOther{0x1018, 1};

/// The delay of the second copy. What a node says comes in its order: the next answer waits for it.
class SdoDoubled : public testing::TestWithParam<Duration> {
 protected:
  Result<Bytes> run() {
    for (;;) {
      while (const auto sent = client.take_frame()) {
        server.on_frame(*sent, now);
        while (const auto answer = server.take_frame()) put(*answer);
      }
      if (auto end = client.take_result()) return *end;
      const auto due = coming.empty() ? kNever : coming.front().first;
      now = std::max(now, std::min(due, client.deadline()));
      if (due <= now) {
        client.on_frame(coming.front().second, now);
        coming.pop_front();
      }
      client.on_time(now);
    }
  }
  void put(const can::Frame& answer) {
    auto time = now + 1ms;
    if (!coming.empty()) time = std::max(time, coming.back().first);
    coming.emplace_back(time, answer);
    coming.emplace_back(time + GetParam(), answer);
  }
  Result<Bytes> read(Transfer transfer = Transfer::automatic, ObjectAddress object = kObject) {
    client.start_upload(object, now, transfer);
    return run();
  }
  Result<Bytes> write(const Bytes& data, Transfer transfer = Transfer::automatic) {
    client.start_download(kObject, data, now, transfer);
    return run();
  }
  /// As every program begins: the node is asked who it is.
  void identify() {
    store.value = {0x92, 0x01, 0x02, 0x00};
    ASSERT_TRUE(read(Transfer::automatic, {0x1000, 0}));
    ASSERT_TRUE(read(Transfer::automatic, kOther));
  }
  /// Values of one size that differ, read and written in turn, as often as a toggle bit has states and more.
  void expect_all_right(std::size_t size, Transfer transfer) {
    identify();
    for (std::uint8_t round = 0; round < 5; ++round) {
      SCOPED_TRACE(static_cast<int>(round));
      auto value = counted(size);
      for (auto& byte : value) byte = static_cast<std::uint8_t>(byte + 16 * round + 1);
      const auto written = write(value, transfer);
      ASSERT_TRUE(written) << written.error().message.text();
      EXPECT_EQ(store.value, value);
      const auto back = read(transfer);
      ASSERT_TRUE(back) << back.error().message.text();
      EXPECT_EQ(*back, value);
      // Changed by the drive itself.
      for (auto& byte : value) ++byte;
      store.value = value;
      const auto again = read(transfer);
      ASSERT_TRUE(again) << again.error().message.text();
      EXPECT_EQ(*again, value) << "not an older one";
    }
  }

  OneObject store;
  SdoServer server{2, store, {}};
  SdoClient client{2, 500ms};
  TimePoint now{1s};
  std::deque<std::pair<TimePoint, can::Frame>> coming;
};

TEST_P(SdoDoubled, ExpeditedTransfersAreRight) { expect_all_right(4, Transfer::automatic); }
TEST_P(SdoDoubled, SegmentedTransfersAreRight) { expect_all_right(60, Transfer::segmented); }
TEST_P(SdoDoubled, BlockTransfersAreRight) { expect_all_right(2000, Transfer::block); }

TEST_P(SdoDoubled, ARefusalIsNotHiddenByTheConfirmationBeforeIt) {
  identify();
  ASSERT_TRUE(write({1, 2}));
  store.refusal = 0x0609'0030;
  const auto refused = write({3, 4});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().abort_code, 0x0609'0030U);
  store.refusal = 0;
  EXPECT_TRUE(write({5, 6}));
  EXPECT_EQ(store.value, (Bytes{5, 6}));
}

TEST_P(SdoDoubled, WhatMustNotWaitGoesOutAtOnce) {
  identify();
  ASSERT_TRUE(write({1, 2}));
  client.start_download(kObject, {3, 4}, now);
  client.go_at_once(now);
  EXPECT_TRUE(client.may_send());
  EXPECT_TRUE(run());
  EXPECT_EQ(store.value, (Bytes{3, 4}));
}

/// The write waits for a copy of the answer before it, and the refusal that comes instead has a copy as well.
TEST(SdoDoubledRefusal, ItsCopyDoesNotEndTheWriteThatWasSentBetween) {
  constexpr ObjectAddress kMode{0x6060, 0};
  SdoClient client{2, 500ms};
  TimePoint now{1s};
  client.start_download(kMode, {1}, now);
  play(client, now, {"> 602#2F60600001000000", "< 582#6060600000000000"});
  EXPECT_TRUE(client.take_result().value());
  client.on_frame(frame("582#6060600000000000"), now);
  client.start_download(kMode, {2}, now);
  play(client, now, {"> 602#2F60600002000000", "< 582#6060600000000000"});
  EXPECT_TRUE(client.take_result().value());
  client.on_frame(frame("602#4060600000000000"), now);
  client.start_download(kMode, {3}, now);
  play(client, now,
       {"< 582#8060600022000008", "> 602#2F60600003000000", "< 582#8060600022000008",
        "< 582#6060600000000000"});
  const auto end = client.take_result();
  ASSERT_TRUE(end);
  EXPECT_TRUE(*end);
}

INSTANTIATE_TEST_SUITE_P(Delays, SdoDoubled, testing::Values(Duration(0ms), Duration(3ms), Duration(20ms)),
                         [](const auto& one) { return "After" + std::to_string(one.param / 1ms) + "ms"; });

}  // namespace
}  // namespace servoctl::canopen
