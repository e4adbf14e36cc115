// What gateways answer: CANopenNode (309/CO_gateway_ascii.c), lely-core (src/co/gw_txt.c).
#include "gateway/client.hpp"

#include <gtest/gtest.h>

namespace servoctl::gateway {
namespace {

using namespace std::chrono_literals;

class GatewayClientTest : public testing::Test {
 protected:
  void start(std::string_view request = "1 4 r 0x1017 0 d") { sent = client.start(request, now, 1s); }
  /// The text of the answer; `silent`, or `-` for none yet.
  std::string outcome() {
    const auto out = client.take_outcome();
    if (!out) return "-";
    return out->silent ? "silent" : out->answer.text;
  }

  Client client;
  TimePoint now{};
  std::string sent;
};

TEST_F(GatewayClientTest, NumbersItsRequests) {
  start();
  EXPECT_EQ(sent, "[1] 1 4 r 0x1017 0 d\r\n");
  client.on_bytes("[1] 6AM=\r\n", now);
  EXPECT_EQ(outcome(), "6AM=");
  EXPECT_FALSE(client.busy());
  start();
  EXPECT_EQ(sent, "[2] 1 4 r 0x1017 0 d\r\n");
}

TEST_F(GatewayClientTest, ALateAnswerIsNotThatOfTheNextRequest) {
  start();
  now += 1s;
  client.on_time(now);
  EXPECT_EQ(outcome(), "silent");
  start();
  client.on_bytes("[1] AAAA\r\n", now);
  EXPECT_EQ(outcome(), "-");
  client.on_bytes("[2] 6AM=\r\n", now);
  EXPECT_EQ(outcome(), "6AM=");
  client.on_bytes("[2] AAAA\r\n", now);
  EXPECT_EQ(outcome(), "-") << "nothing is under way";
}

TEST_F(GatewayClientTest, WhatIsToldUnaskedIsNoAnswer) {
  start();
  client.on_bytes("1 4 BOOT_UP\r\n1 4 EMCY 8130 11 0 0 0 0 0\r\n\r\n1 4 ERROR 203 (Heartbeat lost)\r\n[1] ",
                  now);
  EXPECT_EQ(outcome(), "-");
  client.on_bytes("6AM=\r", now);
  EXPECT_EQ(outcome(), "-");
  client.on_bytes("\n", now);
  EXPECT_EQ(outcome(), "6AM=");
}

TEST_F(GatewayClientTest, BytesOfALongAnswerKeepItWaiting) {
  start();
  for (int i = 0; i < 10; ++i) {
    now += 900ms;
    client.on_bytes(i == 0 ? "[1] AAAA" : "AAAA", now);
    client.on_time(now);
    EXPECT_EQ(outcome(), "-");
  }
  client.on_bytes("\r\n", now);
  EXPECT_EQ(outcome().size(), 40U);
}

TEST_F(GatewayClientTest, WhatIsNoAnswerKeepsNobodyWaiting) {
  start();
  const auto until = client.deadline();
  for (int i = 0; i < 20; ++i) {
    now += 100ms;
    client.on_bytes("1 4 BOOT_UP\r\n# ", now);
  }
  EXPECT_LE(client.deadline(), until);
  client.on_time(now);
  const auto out = client.take_outcome();
  ASSERT_TRUE(out);
  EXPECT_TRUE(out->silent);
}

TEST_F(GatewayClientTest, AnAnswerWithoutAnEndIsNotWaitedForWithoutEnd) {
  start();
  client.on_bytes("[1] A", now);
  for (int i = 0; i < 2000 && client.busy(); ++i) {
    now += 900ms;
    client.on_bytes("A", now);
    client.on_time(now);
  }
  EXPECT_FALSE(client.busy());
}

TEST_F(GatewayClientTest, AnAnswerThatBreaksOffIsNoValue) {
  start();
  client.on_bytes("[1] AAAAAAAA\n...ERROR:0x05040000 #SDO protocol timed out.\r\n", now);
  const auto out = client.take_outcome();
  ASSERT_TRUE(out);
  EXPECT_EQ(out->answer.kind, Answer::Kind::abort) << "CANopenNode tells it behind the half of the value";
  EXPECT_EQ(out->answer.number, 0x0504'0000U);
}

TEST_F(GatewayClientTest, ALineFeedAloneEndsALineWhereNothingFollows) {
  start();
  client.on_bytes("1 4 BOOT_UP\n[1] 6AM=\n", now);
  EXPECT_EQ(outcome(), "-");
  EXPECT_EQ(client.deadline(), now + Client::kQuiet);
  now += Client::kQuiet;
  client.on_time(now);
  EXPECT_EQ(outcome(), "6AM=");
  start();
  client.on_bytes("[2] OK\n", now);
  EXPECT_EQ(outcome(), "OK") << "from then on at once";
}

TEST_F(GatewayClientTest, AnAnswerThatComesTwiceIsNotThatOfTheNextRequest) {
  start();
  client.on_bytes("[1] 5\r\n", now);
  EXPECT_EQ(outcome(), "5");
  start();
  client.on_bytes("[1] 5\r\n", now);
  EXPECT_EQ(outcome(), "-");
  client.on_bytes("[2] 6\r\n[2] 6\r\n", now);
  EXPECT_EQ(outcome(), "6");
}

TEST_F(GatewayClientTest, WhoIsLeftIsNotWaitedFor) {
  start();
  client.abandon();
  EXPECT_FALSE(client.busy());
  start();
  client.on_bytes("[1] AAAA\r\n[2] 6AM=\r\n", now);
  EXPECT_EQ(outcome(), "6AM=");
}

TEST_F(GatewayClientTest, AFloodWithoutAnEndIsNoGateway) {
  start();
  const std::string much(1U << 20U, 'x');
  client.on_bytes("[1] ", now);
  for (int i = 0; i <= 16; ++i) client.on_bytes(much, now);
  EXPECT_TRUE(client.is_broken());
}

TEST_F(GatewayClientTest, AFloodThatIsNoAnswerTakesNoRoomAndHidesNone) {
  start();
  const std::string much(1U << 20U, 'x');
  for (int i = 0; i < 100; ++i) client.on_bytes(much, now);
  EXPECT_FALSE(client.is_broken());
  EXPECT_LE(client.kept(), Client::kLongestOther + 1);
  client.on_bytes(much + '\r', now);
  client.on_bytes("\n[1] 6AM=\r\n", now);
  EXPECT_EQ(outcome(), "6AM=");
}

}  // namespace
}  // namespace servoctl::gateway
