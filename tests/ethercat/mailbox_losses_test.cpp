#include "mailbox_fixture.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

TEST_F(MailboxTest, AMessageWhoseAnswerFrameIsLostIsNotWrittenTwice) {
  slave.latency = 100ms;  // Still in SM0 when it is looked at.
  lose(Command::fpwr, 0x1800, Loss::on_the_way_back);
  send("0020AA");
  run_for(300ms);
  EXPECT_EQ(lost, 1);
  EXPECT_EQ(slave.written.size(), 1U);
  EXPECT_EQ(taken.size(), 1U);
  EXPECT_EQ(came(), "0020AA");
  EXPECT_EQ(mailbox.statistics().doubtful, 0U);
}

TEST_F(MailboxTest, AMessageThatWasTakenAlreadyIsNotWrittenTwiceEither) {
  lose(Command::fpwr, 0x1800, Loss::on_the_way_back);
  send("0020AA");
  run_for(300ms);
  EXPECT_EQ(slave.written.size(), 1U);
  EXPECT_EQ(came(), "0020AA");
  EXPECT_EQ(mailbox.statistics().doubtful, 1U);
}

TEST_F(MailboxTest, AMessageThatNobodyCountedAndThatWasTakenIsNotWrittenTwice) {
  for (const auto latency : {300us, 100'000us}) {
    slave.latency = latency;
    slave.written.clear();
    lost = 0;
    lose(Command::fpwr, 0x1800, Loss::uncounted);
    send("0020AA");
    run_for(300ms);
    EXPECT_EQ(lost, 1);
    EXPECT_EQ(slave.written.size(), 1U);
    EXPECT_EQ(came(), "0020AA");
    EXPECT_EQ(came(), "nothing");
  }
}

TEST_F(MailboxTest, AMessageThatMayNotHaveComeIsNotWrittenAgain) {
  lose(Command::fpwr, 0x1800, Loss::on_the_way_out);
  send("0020AA");
  run_for(2s);
  EXPECT_EQ(slave.written.size(), 0U) << "whether it came cannot be known: the caller decides";
  EXPECT_EQ(came(), "nothing");
  send("0020BB");
  run_for(10ms);
  EXPECT_EQ(came(), "0020BB");
  EXPECT_EQ(slave.written[0][5] >> 4, 2) << "the number of the lost one is not used again";
}

TEST_F(MailboxTest, AMessageThatTheSlaveDidNotTakeIsWrittenAgainUnderItsNumber) {
  slave.latency = 5ms;
  send("0020AA");
  while (slave.written.empty()) step();
  // SM0 looks free and is not: another master has just written.
  auto request = mailbox.take_request();
  mailbox.on_answer(slave.answer(*request, now), now);
  send("0020BB");
  run_for(30ms);
  ASSERT_EQ(slave.written.size(), 2U);
  EXPECT_EQ(slave.written[1][5] >> 4, 2);
}

TEST_F(MailboxTest, AnAnswerThatIsLostIsAskedForAgain) {
  for (int round = 0; round < 3; ++round) {
    lost = 0;
    lose(Command::fprd, 0x1C00, Loss::on_the_way_back);
    send("0020AA");
    run_for(100ms);
    EXPECT_EQ(lost, 2) << "lost once, read once more";
    EXPECT_EQ(came(), "0020AA");
    EXPECT_EQ(came(), "nothing");
  }
  EXPECT_EQ(mailbox.statistics().repeated, 3U);
  EXPECT_EQ(mailbox.statistics().missed, 0U);
  EXPECT_EQ(taken.size(), 3U);
}

TEST_F(MailboxTest, AnAnswerThatWasNotReadIsReadWithoutBeingAskedForAgain) {
  lose(Command::fprd, 0x1C00, Loss::on_the_way_out);
  send("0020AA");
  run_for(100ms);
  EXPECT_EQ(came(), "0020AA");
  EXPECT_EQ(mailbox.statistics().repeated, 0U);
}

TEST_F(MailboxTest, ASlaveThatRepeatsNothingLosesAMessageAndTheMailboxGoesOn) {
  slave.repeats = false;
  lose(Command::fprd, 0x1C00, Loss::on_the_way_back);
  send("0020AA");
  run_for(300ms);
  EXPECT_EQ(came(), "nothing");
  EXPECT_EQ(mailbox.statistics().missed, 1U);
  send("0020BB");
  run_for(10ms);
  EXPECT_EQ(came(), "0020BB");
}

TEST_F(MailboxTest, ARepetitionOfWhatHasComeIsNoAnswer) {
  send("0020AA");
  run_for(5ms);
  EXPECT_EQ(came(), "0020AA");
  send("0020AB");
  run_for(5ms);
  EXPECT_EQ(came(), "0020AB");
  // The slave gives the last but one when it is asked for the last: it has not noticed that that was read.
  slave.repeats = false;
  answers = false;
  lose(Command::fprd, 0x1C00, Loss::on_the_way_back);
  slave.reply(3, hex("0030CC"));
  while (mailbox.statistics().repeated == 0) run_for(1us);
  slave.numbers = {2};
  slave.reply(3, hex("0020AB"));
  run_for(100ms);
  EXPECT_EQ(came(), "nothing");
}

TEST_F(MailboxTest, WhatASlaveThatCountsSendsTwiceIsOneMessage) {
  slave.numbers = {1, 2, 2, 3};
  send("0020AA");
  run_for(5ms);
  EXPECT_EQ(came(), "0020AA");
  send("0020AB");
  run_for(5ms);
  EXPECT_EQ(came(), "0020AB");
  slave.reply(3, hex("0020AB"));
  run_for(5ms);
  EXPECT_EQ(came(), "nothing");
  send("0020AB");
  run_for(5ms);
  EXPECT_EQ(came(), "0020AB");
}

TEST_F(MailboxTest, ASlaveThatIsGoneIsToldToWhoSends) {
  slave.gone = true;
  mailbox.start(now);
  send("0020AA", 100ms);
  run_for(105ms);
  EXPECT_EQ(came(), "it does not answer at all");
  mailbox.listen(false, now);
  frames = 0;
  run_for(1s);
  EXPECT_LE(frames, 12) << "a slave that is gone is not flooded";
}

TEST_F(MailboxTest, WhatIsCancelledIsNotWritten) {
  mailbox.send(hex("0020AA"), now + 1s, now);
  mailbox.cancel();
  run_for(10ms);
  EXPECT_EQ(slave.written.size(), 0U);
}

}  // namespace
}  // namespace servoctl::ethercat
