#include "can/socketcand_dialogue.hpp"

#include <gtest/gtest.h>

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using TalkState = SocketcandDialogue::State;
using ElementKind = SocketcandElement::Kind;

class SocketcandTalk : public testing::Test {
 protected:
  void hear(ElementKind kind, const std::string& text = {}) {
    talk_.on_element({.kind = kind, .text = text}, now_);
  }
  void pass(Duration time) {
    now_ += time;
    talk_.on_time(now_);
  }
  void settle() {
    hear(ElementKind::hi);
    hear(ElementKind::ok);
    hear(ElementKind::ok);
    hear(ElementKind::echo);
    (void)talk_.take_text();
  }

  TimePoint now_{seconds(100)};
  SocketcandDialogue talk_{"can0", now_};
};

TEST_F(SocketcandTalk, GoesToRawModeStepByStep) {
  EXPECT_EQ(talk_.take_text(), "") << "the server speaks first";
  hear(ElementKind::hi);
  EXPECT_EQ(talk_.take_text(), "< open can0 >");
  hear(ElementKind::ok);
  EXPECT_EQ(talk_.take_text(), "< rawmode >");
  hear(ElementKind::ok);
  EXPECT_EQ(talk_.take_text(), "< echo >");
  hear(ElementKind::echo);
  EXPECT_EQ(talk_.state(), TalkState::raw);
}

TEST_F(SocketcandTalk, ARefusalIsTold) {
  hear(ElementKind::hi);
  hear(ElementKind::refusal, "could not open bus");
  EXPECT_EQ(talk_.state(), TalkState::refused);
  EXPECT_EQ(talk_.why(), "could not open bus");
}

TEST_F(SocketcandTalk, WhoGreetsInAnotherWayIsAStranger) {
  hear(ElementKind::damaged);
  EXPECT_EQ(talk_.state(), TalkState::stranger);
}

TEST_F(SocketcandTalk, EachAnswerIsWaitedFor) {
  pass(milliseconds(2900));
  hear(ElementKind::hi);
  pass(milliseconds(2900));
  EXPECT_EQ(talk_.state(), TalkState::opening);
  pass(milliseconds(200));
  EXPECT_EQ(talk_.state(), TalkState::silent);
}

TEST_F(SocketcandTalk, NoMoreIsUnderWayThanTheServerHasRead) {
  settle();
  std::size_t sent = 0;
  std::size_t echoes = 0;
  for (; talk_.has_room(36) && sent < 100'000; sent += 36) {
    talk_.on_sent(36, now_);
    echoes += talk_.take_text() == "< echo >";
  }
  EXPECT_LE(sent, SocketcandDialogue::kWindow);
  EXPECT_GE(sent, SocketcandDialogue::kWindow / 2);
  EXPECT_GE(echoes, 3U);
  hear(ElementKind::echo);
  EXPECT_TRUE(talk_.has_room(36));
}

TEST_F(SocketcandTalk, AServerThatIsQuietIsAskedAndThenGivenUp) {
  settle();
  pass(milliseconds(1100));
  EXPECT_EQ(talk_.take_text(), "< echo >");
  pass(milliseconds(2000));
  EXPECT_EQ(talk_.state(), TalkState::raw);
  hear(ElementKind::echo);
  pass(milliseconds(1100));
  EXPECT_EQ(talk_.take_text(), "< echo >");
  pass(milliseconds(3100));
  EXPECT_EQ(talk_.state(), TalkState::silent);
}

TEST_F(SocketcandTalk, FramesAreASignOfLife) {
  settle();
  talk_.on_sent(600, now_);
  EXPECT_EQ(talk_.take_text(), "< echo >");
  for (int i = 0; i < 10; ++i) {
    pass(milliseconds(2000));
    talk_.on_life(now_);
  }
  EXPECT_EQ(talk_.state(), TalkState::raw);
}

TEST_F(SocketcandTalk, AServerWithoutEchoIsNotAskedAgain) {
  hear(ElementKind::hi);
  hear(ElementKind::ok);
  hear(ElementKind::ok);
  (void)talk_.take_text();
  pass(milliseconds(1100));
  EXPECT_EQ(talk_.state(), TalkState::raw);
  EXPECT_TRUE(talk_.has_room(1'000'000));
  talk_.on_sent(1'000'000, now_);
  EXPECT_EQ(talk_.take_text(), "");
  EXPECT_EQ(talk_.deadline(), kNever);
}

}  // namespace
}  // namespace servoctl::can
