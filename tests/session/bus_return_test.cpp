#include "session/bus_return.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "session/can_network.hpp"
#include "session/identify.hpp"
#include "session/snapshot.hpp"
#include "tests/session/scripted_bus.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

class BusReturnTest : public testing::Test {
 protected:
  void SetUp() override {
    auto owned = std::make_unique<ScriptedBus>();
    wire = owned.get();
    Options options;
    options.cancelled = [this] { return session->now() >= interrupted; };
    options.tell = [this](std::string_view line) { told.emplace_back(line); };
    session = std::make_unique<Session>(std::move(owned), "can0", std::move(options));
  }

  /// Waits until the bus is lost; then for it.
  Result<void> lose_and_wait(BusReturn& bus, Duration patience) {
    const auto lost = session->wait([] { return false; }, session->now() + 10s);
    EXPECT_FALSE(lost);
    return bus.wait(lost.error(), session->now() + patience);
  }

  ScriptedBus* wire = nullptr;
  std::unique_ptr<Session> session;
  TimePoint interrupted = kNever;
  std::vector<std::string> told;
};

TEST_F(BusReturnTest, GoesOnWhenTheBusIsBackAndTellsBothOnce) {
  wire->lose(TimePoint(2s), TimePoint(5200ms));
  BusReturn bus(*session, BusReturn::to_people(*session));
  EXPECT_TRUE(lose_and_wait(bus, 10s));
  EXPECT_EQ(told, (std::vector<std::string>{"can0 went down: waiting until it can be used again",
                                            "can0 can be used again after 3.2 s"}));
  EXPECT_TRUE(session->was_away());
  EXPECT_EQ(session->now(), TimePoint(5200ms));
}

TEST_F(BusReturnTest, EndsWithTheLossWhereItIsNotBackInTime) {
  wire->lose(TimePoint(2s), TimePoint(30s));
  BusReturn bus(*session, BusReturn::to_people(*session));
  const auto ended = lose_and_wait(bus, 10s);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().message.text(), "can0 went down");
  EXPECT_EQ(session->now(), TimePoint(12s));
  EXPECT_EQ(told.size(), 1U);
  EXPECT_FALSE(session->was_away());
}

TEST_F(BusReturnTest, EndsAtOnceWhenSomebodyInterrupts) {
  wire->lose(TimePoint(2s), TimePoint(30s));
  interrupted = TimePoint(3s);
  BusReturn bus(*session, BusReturn::to_people(*session));
  EXPECT_FALSE(lose_and_wait(bus, 10s));
  EXPECT_LE(session->now(), TimePoint(3100ms));
}

TEST_F(BusReturnTest, DoesNotWaitWhereServoctlSendsSomethingRegularly) {
  wire->lose(TimePoint(2s), TimePoint(3s));
  BusReturn bus(*session, BusReturn::to_people(*session));
  session->can()->produce_sync({.period = 100ms});
  EXPECT_FALSE(lose_and_wait(bus, 10s));
  session->can()->stop_sync();
  session->can()->produce_heartbeat(100, 100ms);
  EXPECT_FALSE(lose_and_wait(bus, 10s));
  session->can()->stop_heartbeat();
  session->energised().insert(1);
  EXPECT_FALSE(lose_and_wait(bus, 10s));
  EXPECT_EQ(session->now(), TimePoint(2s));
  EXPECT_EQ(told.size(), 0U);
}

TEST_F(BusReturnTest, DoesNotTakeABusThatFailsForOneThatComesBack) {
  for (int i = 0; i < 5; ++i) wire->lose(TimePoint(2s), TimePoint(2s));
  BusReturn bus(*session, BusReturn::to_people(*session));
  EXPECT_TRUE(lose_and_wait(bus, 10s));
  EXPECT_FALSE(lose_and_wait(bus, 10s));
  EXPECT_EQ(told, (std::vector<std::string>{"can0 went down: waiting until it can be used again",
                                            "can0 was opened anew at once"}));
}

TEST_F(BusReturnTest, EndsWhereABusThatWasOpenedAnewIsNoBetterForWhoeverIsAsked) {
  // A queue that stays full: it can be opened at any time, and each request fails after its time.
  wire->on_send = [](ScriptedBus& it, const std::string& sent) {
    const auto object = sent.substr(6, 6);
    it.arrive(object == "001000" ? "581#4300100092010200" : "581#80" + object + "00000206");
  };
  const std::uint8_t nodes[] = {1};
  ASSERT_TRUE(identify(*session, nodes, drive::Rules{}).front());
  for (int i = 0; i < 20; ++i) wire->lose(TimePoint(2s), TimePoint(2s));
  wire->failing = 4s;
  BusReturn bus(*session, BusReturn::to_people(*session), nodes);
  EXPECT_FALSE(lose_and_wait(bus, 10s));
  EXPECT_EQ(session->now(), TimePoint(6s)) << "asked once";
  EXPECT_FALSE(lose_and_wait(bus, 10s));
  EXPECT_EQ(told.size(), 2U);
}

TEST_F(BusReturnTest, IsRefusedWhereAnotherDriveIsThereNow) {
  // Answers 1000h and 1018h:01, and refuses all else; the vendor is another one behind the loss.
  std::string vendor = "11000000";
  wire->on_send = [&](ScriptedBus& it, const std::string& sent) {
    const auto object = sent.substr(6, 6);
    if (object == "001000")
      it.arrive("581#4300100092010200");
    else if (object == "181001")
      it.arrive("581#43181001" + vendor);
    else
      it.arrive("581#80" + object + "00000206");
  };
  const std::uint8_t nodes[] = {1};
  ASSERT_TRUE(identify(*session, nodes, drive::Rules{}).front());
  wire->lose(TimePoint(2s), TimePoint(3s));
  wire->lose(TimePoint(8s), TimePoint(9s));
  BusReturn bus(*session, BusReturn::to_people(*session), nodes);
  EXPECT_TRUE(lose_and_wait(bus, 10s)) << "the same one";
  vendor = "22000000";
  const auto back = lose_and_wait(bus, 10s);
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, Errc::refused);
  EXPECT_EQ(back.error().message.text(),
            "node 1: another drive is there than before the bus was lost: its vendor (1018h:01) is another");
  EXPECT_EQ(back.error().node, 1);
}

TEST_F(BusReturnTest, DoesNotTakeTheTimeWithoutTheBusForASilenceOfNodes) {
  for (int i = 1; i <= 4; ++i) wire->arrive("705#05", i * 200ms);
  wire->lose(TimePoint(2s), TimePoint(5s));
  BusReturn bus(*session, BusReturn::to_people(*session));
  ASSERT_TRUE(lose_and_wait(bus, 10s));
  wire->arrive("705#05", 150ms);
  (void)session->wait([] { return false; }, session->now() + 500ms);
  const auto before = session->take_events();
  EXPECT_EQ(before.size(), 0U);
  EXPECT_EQ(session->can()->watch().period(5), 200ms);
  // From there on it counts: the node may have gone meanwhile.
  (void)session->wait([] { return false; }, session->now() + 1s);
  EXPECT_EQ(session->take_events().size(), 1U);
}

TEST_F(BusReturnTest, WhatWasKnownOfTheNodesIsForgotten) {
  session->can()->learn_pdos(1, {}, session->can()->epoch(1));
  session->can()->lss_selection() = canopen::LssAddress{1, 2, 3, 4};
  wire->lose(TimePoint(2s), TimePoint(3s));
  BusReturn bus(*session, BusReturn::to_people(*session));
  ASSERT_TRUE(lose_and_wait(bus, 10s));
  EXPECT_EQ(session->can()->known_pdos(1), nullptr);
  EXPECT_FALSE(session->can()->lss_selection());
}

TEST_F(BusReturnTest, WhatAWaitOrATransferMissedIsKnown) {
  EXPECT_FALSE(session->take_met_loss());
  wire->lose(session->now(), TimePoint(30s));
  EXPECT_FALSE(session->upload(1, {0x1000, 0}));
  EXPECT_TRUE(session->take_met_loss());
  EXPECT_FALSE(session->take_met_loss()) << "what follows is another line";
}

/// What the kernel tells of the wire: a form error, as the SJA1000 driver writes it (linux/can/error.h). Its
/// class has the bits of the identifier of node 8's emergencies.
can::Frame form_error() {
  can::Frame out;
  out.error = true;
  out.id = 0x088;
  out.size = 8;
  out.data = {0, 0, 0x02, 0x1B};
  return out;
}

TEST_F(BusReturnTest, ErrorsOnTheWireAreTheReasonOfASilenceAndNoMessages) {
  for (int i = 1; i <= 4; ++i) wire->arrive(form_error(), i * 10ms);
  const auto answer = session->upload(8, {0x1000, 0});
  ASSERT_FALSE(answer);
  EXPECT_EQ(
      answer.error().hint.text(),
      "there were errors on the wire (4 × form error): another bitrate, wiring or termination? `doctor can0` tells them "
      "apart");
  EXPECT_EQ(session->take_events().size(), 0U);
  EXPECT_EQ(session->can()->wire_errors().damage(), 4U);
}

TEST_F(BusReturnTest, ErrorsThatAreLongOverAreNotTheReasonOfASilence) {
  for (int i = 1; i <= 4; ++i) wire->arrive(form_error(), i * 10ms);
  (void)session->wait([] { return false; }, session->now() + 10s);
  const auto answer = session->upload(8, {0x1000, 0});
  ASSERT_FALSE(answer);
  EXPECT_TRUE(answer.error().hint.text().starts_with("is node 8 powered")) << answer.error().hint.text();
}

TEST_F(BusReturnTest, OneErrorOnTheWireIsAnAccident) {
  wire->arrive(form_error(), 10ms);
  const auto answer = session->upload(8, {0x1000, 0});
  ASSERT_FALSE(answer);
  EXPECT_TRUE(answer.error().hint.text().starts_with("is node 8 powered")) << answer.error().hint.text();
}

TEST_F(BusReturnTest, ASecondNodeIsWaitedForAsLongAsItTakes) {
  // Both say the same of themselves, the second 80 ms later.
  wire->on_send = [](ScriptedBus& it, const std::string& sent) {
    if (!sent.starts_with("601#40")) return;
    const auto answer = "581#43" + sent.substr(6, 6) + "01000000";
    it.arrive(answer, 1ms);
    it.arrive(answer, 80ms);
  };
  const std::uint8_t nodes[] = {1};
  ASSERT_TRUE(session->upload(1, {0x1000, 0}));
  ASSERT_TRUE(settle_duplicates(*session, nodes, kScanning));
  EXPECT_FALSE(refuse_duplicate(*session, 1));
}

}  // namespace
}  // namespace servoctl::session
