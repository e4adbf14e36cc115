// What a bus with other masters, disturbances and broken nodes does to a transfer: it ends in bounded time,
// with the right result or one clear error.
#include <gtest/gtest.h>

#include "scripted_bus.hpp"
#include "session/can_network.hpp"
#include "session/session.hpp"
#include "session/write.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

constexpr auto kReadStatus = "602#4041600000000000";
constexpr auto kStatus = "582#4B41600050020000";

class HostileBus : public testing::Test {
 protected:
  HostileBus() {
    auto owned = std::make_unique<ScriptedBus>();
    bus = owned.get();
    session = std::make_unique<Session>(std::move(owned), "can0", Options{});
  }
  Result<Bytes> read_status() { return session->upload(2, {0x6041, 0}); }

  ScriptedBus* bus = nullptr;
  std::unique_ptr<Session> session;
};

TEST_F(HostileBus, TakesNoAnswerOfAnotherObjectNodeOrKindOfFrame) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent != kReadStatus) return;
    for (const auto* noise :
         {"582#4B40600011110000", "583#4B41600011110000", "00000582#4B41600011110000", "582#R8",
          "182#4B41600011110000", "702#05", "082#2081010000000000", "20000004#0004000000000000"})
      b.arrive(noise);
    b.arrive(kStatus, 2ms);
  };
  EXPECT_EQ(read_status().value(), (Bytes{0x50, 0x02}));
  EXPECT_EQ(bus->sent.size(), 1U);
}

TEST_F(HostileBus, TakesALateAnswerOfAnEarlierReadForNothingElse) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent == kReadStatus) b.arrive(kStatus, 1200ms);  // Both tries have given up by then.
    if (sent == "602#4061600000000000") b.arrive("582#4F61600003000000", 400ms);
  };
  EXPECT_EQ(read_status().error().code, Errc::timeout);
  EXPECT_EQ(session->upload(2, {0x6061, 0}).value(), Bytes{3});
}

TEST_F(HostileBus, IsNotConfusedByAnswersThatComeTwice) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    for (int i = 0; i < 2; ++i) {
      if (sent == kReadStatus) b.arrive(kStatus);
      if (sent == "602#4061600000000000") b.arrive("582#4F61600003000000");
    }
  };
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(read_status().value(), (Bytes{0x50, 0x02}));
    EXPECT_EQ(session->upload(2, {0x6061, 0}).value(), Bytes{3});
  }
}

TEST_F(HostileBus, KeepsItsTimeInAStormAndTellsARepeatedEmergencyOnce) {
  for (int i = 0; i < 20'000; ++i) {
    bus->arrive("083#1081010000000000", i * 100us);
    bus->arrive("702#05", i * 100us);
  }
  const auto before = session->now();
  const auto answer = read_status();
  EXPECT_EQ(answer.error().code, Errc::timeout);
  EXPECT_LE(session->now() - before, 1001ms);
  const auto events = session->take_events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].node, 3);
  EXPECT_GT(events[0].times, 9'000U);
}

TEST_F(HostileBus, AnswersInAStorm) {
  for (int i = 0; i < 1000; ++i) bus->arrive("083#1081010000000000", i * 10us);
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent == kReadStatus) b.arrive(kStatus, 9ms);
  };
  EXPECT_TRUE(read_status());
}

TEST_F(HostileBus, ToleratesAnotherMasterWhileAnswersTellWhoseTheyAre) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent != kReadStatus) return;
    b.arrive("602#4061600000000000");
    b.arrive("582#4F61600003000000");
    b.arrive(kStatus, 2ms);
  };
  EXPECT_EQ(read_status().value(), (Bytes{0x50, 0x02}));
}

TEST_F(HostileBus, EndsASegmentedTransferWhenAnotherMasterSpeaksToTheNode) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent == "602#4008100000000000") b.arrive("582#410810000E000000");
    if (sent == "602#6000000000000000") b.arrive("602#4061600000000000");
  };
  const auto before = session->now();
  const auto answer = session->upload(2, {0x1008, 0});
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Errc::protocol);
  EXPECT_EQ(answer.error().message.text(),
            "node 2, object 0x1008:0: another master uses its SDO channel at the same time");
  EXPECT_LT(session->now() - before, 10ms);
  EXPECT_EQ(bus->sent.size(), 2U) << "an abort would end the other master's transfer";
}

TEST_F(HostileBus, HintsAtAnotherMasterWhenItsTransferFails) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent == kReadStatus) b.arrive("602#4061600000000000");
  };
  const auto answer = read_status();
  EXPECT_EQ(answer.error().code, Errc::timeout);
  EXPECT_EQ(answer.error().hint.text(), "another master is also using SDO with this node");
}

TEST_F(HostileBus, EndsAtOnceWhenTheControllerGoesBusOff) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent == kReadStatus) b.arrive("20000040#0000000000000090");
  };
  const auto before = session->now();
  const auto answer = read_status();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Errc::bus);
  EXPECT_EQ(answer.error().message.text(),
            "can0: bus-off: the controller has left the bus after too many errors");
  EXPECT_LT(session->now() - before, 10ms);
}

TEST_F(HostileBus, TellsWhatTheControllerReportsOnceUntilItChanges) {
  for (int i = 0; i < 50; ++i) bus->arrive("20000004#0001000000000000");
  bus->arrive("20000004#0010000000000000", 2ms);
  bus->arrive("20000004#0010000000000000", 3ms);
  bus->arrive("20000004#0040000000000000", 4ms);
  (void)session->wait([] { return false; }, session->now() + 10ms);
  EXPECT_EQ(session->can()->take_reports(),
            (std::vector<can::ControllerReport>{can::ControllerReport::overflow,
                                                can::ControllerReport::error_passive,
                                                can::ControllerReport::error_active}));
  EXPECT_TRUE(session->can()->take_reports().empty());
}

TEST_F(HostileBus, ReadsAgainSoonWhenTheNodeBootsInMidTransfer) {
  int asked = 0;
  bus->on_send = [&asked](ScriptedBus& b, const std::string& sent) {
    if (sent == kReadStatus) b.arrive(asked++ == 0 ? "702#00" : kStatus);
  };
  const auto before = session->now();
  EXPECT_EQ(read_status().value(), (Bytes{0x50, 0x02}));
  EXPECT_LT(session->now() - before, 150ms);
}

TEST_F(HostileBus, LooksUpAWriteInWhichTheNodeBooted) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent == "602#2F60600003000000") b.arrive("702#00");
    if (sent == "602#4060600000000000") b.arrive("582#4F60600001000000");
  };
  const SdoRequest request{2, {0x6060, 0}, Bytes{3}};
  const auto written = write_all(*session, std::span(&request, 1), false);
  ASSERT_FALSE(written.front());
  EXPECT_EQ(
      written.front().error().message.text(),
      "node 2, object 0x6060:0: the write was sent, but no answer came, and it had no effect: the object "
      "holds 01");
  EXPECT_EQ(std::count(bus->sent.begin(), bus->sent.end(), "602#2F60600003000000"), 1);
}

TEST_F(HostileBus, LooksUpAWriteWhoseAnswerWasNonsense) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent == "602#2F60600003000000") b.arrive("582#4360600000000000");
    if (sent == "602#4060600000000000") b.arrive("582#4F60600003000000");
  };
  const SdoRequest request{2, {0x6060, 0}, Bytes{3}};
  const auto written = write_all(*session, std::span(&request, 1), false);
  ASSERT_TRUE(written.front());
  EXPECT_TRUE(written.front()->answer_lost);
}

TEST_F(HostileBus, TakesTheObjectsSizeWhereTheAnswerDoesNotSayIt) {
  bus->on_send = [](ScriptedBus& b, const std::string& sent) {
    if (sent == kReadStatus) b.arrive("582#4241600050021122");
  };
  EXPECT_EQ(read_status().value().size(), 4U);
  const SdoRequest request{.node = 2, .object = {0x6041, 0}, .size = 2};
  EXPECT_EQ(session->transfer(std::span(&request, 1)).front().value(), (Bytes{0x50, 0x02}));
}

TEST_F(HostileBus, TellsTheNodeWhenItGivesUp) {
  EXPECT_FALSE(read_status());
  EXPECT_EQ(bus->sent, (std::vector<std::string>{kReadStatus, "602#8041600000000405", kReadStatus,
                                                 "602#8041600000000405"}));
}

}  // namespace
}  // namespace servoctl::session
