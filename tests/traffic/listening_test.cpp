#include "traffic/listening.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "session/can_network.hpp"
#include "tests/session/scripted_bus.hpp"

namespace servoctl::traffic {
namespace {

using namespace std::chrono_literals;

class ListeningTest : public testing::Test {
 protected:
  void SetUp() override {
    auto owned = std::make_unique<session::ScriptedBus>();
    wire = owned.get();
    line = std::make_unique<session::Session>(std::move(owned), "can0", session::Options());
    listener.on_frame = [this](const can::Frame& frame, TimePoint) { heard.push_back(frame.id); };
    wire->arrive("181#00", 500ms);
    wire->arrive("182#00", 1500ms);
    wire->arrive("183#00", 4500ms);
    wire->lose(TimePoint(2s), TimePoint(4s));
  }

  session::ScriptedBus* wire = nullptr;
  std::unique_ptr<session::Session> line;
  Listener listener;
  std::vector<std::uint32_t> heard;
  std::vector<std::string> told;
};

TEST_F(ListeningTest, EndsWithTheBusWhereItIsNotWaitedFor) {
  const auto ended = listen(*line, 10s, listener);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, Errc::bus);
  EXPECT_EQ(heard, std::vector<std::uint32_t>{0x181});
}

TEST_F(ListeningTest, GoesOnBehindABusThatCameBackUntilItsOwnEnd) {
  listener.on_bus = [this](bool back, std::string_view text) {
    told.push_back((back ? "back: " : "lost: ") + std::string(text));
  };
  ASSERT_TRUE(listen(*line, 10s, listener));
  EXPECT_EQ(heard, (std::vector<std::uint32_t>{0x181, 0x183}));
  EXPECT_EQ(told, (std::vector<std::string>{"lost: can0 went down: waiting until it can be used again",
                                            "back: can0 can be used again after 2 s"}));
  EXPECT_EQ(line->now(), TimePoint(11s));
}

TEST_F(ListeningTest, EndsWithTheBusThatIsNotBackAtItsEnd) {
  listener.on_bus = [](bool, std::string_view) {};
  const auto ended = listen(*line, 2s, listener);
  ASSERT_FALSE(ended);
  EXPECT_EQ(line->now(), TimePoint(3s));
}

TEST_F(ListeningTest, ALostBusLeavesTheSummaryOfWhatCameBefore) {
  std::vector<Error> errors;
  EXPECT_TRUE(has_summary({}, errors));
  EXPECT_TRUE(errors.empty());
  EXPECT_TRUE(has_summary(fail(Errc::bus, "can0 went down"), errors));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors.front().message.text(), "can0 went down");
  EXPECT_FALSE(has_summary(fail(Errc::refused, "another drive is there"), errors));
  EXPECT_EQ(errors.size(), 1U) << "it is the error of the line itself";
}

TEST_F(ListeningTest, WhatIsDueGoesOnToo) {
  listener.on_bus = [](bool, std::string_view) {};
  auto next = line->now();
  int looks = 0;
  listener.next = [&] { return next; };
  listener.on_time = [&](TimePoint now) -> Result<void> {
    next = now + 1s;
    ++looks;
    // As a read on a bus that is lost.
    if (const auto sent = line->can()->send(*can::parse_frame("601#4041600000000000")); !sent) return sent;
    return {};
  };
  ASSERT_TRUE(listen(*line, 10s, listener));
  EXPECT_GE(looks, 7);
}

}  // namespace
}  // namespace servoctl::traffic
