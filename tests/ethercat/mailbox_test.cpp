#include "ethercat/mailbox.hpp"

#include "hex.hpp"
#include "mailbox_slave.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;
using Loss = MailboxSlave::Loss;

constexpr SiiMailbox kPlace{0x1800, 64, 0x1C00, 48};

class MailboxTest : public testing::Test {
 protected:
  MailboxTest() {
    slave.handler = [this](std::uint8_t type, const Bytes& data) {
      taken.push_back(data);
      EXPECT_EQ(type, 3);
      if (answers) slave.reply(3, data);
    };
    mailbox.start(now);
    run_for(1ms);
  }

  /// One request of the machine; the ring would repeat what may be.
  bool step() {
    const auto request = mailbox.take_request();
    if (!request) return false;
    ++frames;
    now += 50us;
    auto answer = slave.answer(*request, now);
    for (int tries = 0; answer.lost && request->repeatable && tries < 2; ++tries) {
      now += 20ms;
      answer = slave.answer(*request, now);
    }
    if (answer.lost) now += 20ms;
    mailbox.on_answer(answer, now);
    return true;
  }
  void run_for(Duration time) {
    const auto end = now + time;
    for (int steps = 0; now < end && steps < 100'000; ++steps) {
      slave.run(now);
      if (step()) continue;
      now = std::min(end, std::max(now + 1us, std::min(mailbox.deadline(), slave.next())));
      mailbox.on_time(now);
    }
  }
  void send(std::string_view message, Duration time = 1s) {
    mailbox.send(hex(message), now + time, now);
    mailbox.listen(true, now);
  }
  /// The next message that came, as hex; what else came is told in words.
  std::string came() {
    const auto event = mailbox.take_event();
    if (!event) return "nothing";
    if (const auto* message = std::get_if<Mailbox::Message>(&*event))
      return to_hex(message->data, "") + (message->early ? " early" : "");
    if (const auto* refusal = std::get_if<Mailbox::Refusal>(&*event))
      return "refused: " + mailbox_error_text(refusal->detail);
    return std::get<Mailbox::Failure>(*event).what;
  }
  /// The nth frame of this kind is lost.
  void lose(Command command, std::uint16_t where, Loss how, int times = 1) {
    slave.loss = [=, this](const Request& request) {
      const bool meant = request.command == command && request.address >> 16U == where;
      return meant && lost++ < times ? how : Loss::none;
    };
  }

  MailboxSlave slave{kPlace};
  Mailbox mailbox{4, SlaveAddress::station(0x1004), Mailbox::Options{kPlace}};
  TimePoint now{1s};
  std::vector<Bytes> taken;
  bool answers = true;
  int frames = 0;
  int lost = 0;
};

TEST_F(MailboxTest, AMessageFillsTheWholeMailboxAndIsNumbered) {
  // As frame 281 of dumps/soem-sdinfo-akd.pcapng of ethercrab (MIT or Apache-2.0) begins.
  send("002040001C0000000000");
  run_for(5ms);
  ASSERT_EQ(slave.written.size(), 1U);
  EXPECT_EQ(slave.written[0].size(), 64U);
  EXPECT_EQ(to_hex(ByteSpan(slave.written[0]).first(16), ""), "0A0000000013002040001C0000000000");
  EXPECT_EQ(came(), "002040001C0000000000");
  EXPECT_EQ(came(), "nothing");
}

TEST_F(MailboxTest, MessagesAreNumberedOneToSevenAndRound) {
  for (int i = 0; i < 9; ++i) {
    send("0020");
    run_for(5ms);
  }
  ASSERT_EQ(slave.written.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(slave.written[i][5] >> 4, i % 7 + 1);
  EXPECT_EQ(taken.size(), 9U);
}

TEST_F(MailboxTest, ARequestAndItsAnswerTakeThreeFrames) {
  slave.latency = 0us;
  send("0020");
  run_for(5ms);
  EXPECT_EQ(came(), "0020");
  mailbox.listen(false, now);
  run_for(1ms);
  frames = 0;
  send("0021");
  while (came() != "0021") step();
  EXPECT_EQ(frames, 3) << "write, look, read";
}

TEST_F(MailboxTest, WhatSomebodyElseLeftIsThrownAwayFirst) {
  slave.reply(3, hex("0030FF"));
  slave.reply(3, hex("0030EE"));
  mailbox.start(now);
  send("0020AA");
  run_for(10ms);
  EXPECT_EQ(came(), "0020AA");
  EXPECT_EQ(came(), "nothing");
  EXPECT_EQ(mailbox.statistics().left_behind, 2U);
}

TEST_F(MailboxTest, AFullMailboxIsWaitedFor) {
  slave.latency = 100ms;
  send("0020AA");
  run_for(1ms);
  send("0020BB");
  run_for(50ms);
  EXPECT_EQ(slave.written.size(), 1U);
  run_for(300ms);
  EXPECT_EQ(came(), "0020AA early") << "no answer to the second: that was not written yet";
  EXPECT_EQ(came(), "0020BB");
}

TEST_F(MailboxTest, AMailboxThatStaysFullIsTold) {
  slave.stuck = true;
  send("0020AA");
  run_for(1ms);
  send("0020BB", 300ms);
  run_for(299ms);
  EXPECT_EQ(came(), "nothing");
  run_for(3ms);
  EXPECT_EQ(came(), "its mailbox stays full");
  EXPECT_FALSE(mailbox.sending());
}

TEST_F(MailboxTest, ASlaveThatWaitsForItsOwnMessageToBeReadGetsThat) {
  slave.handler = [this](std::uint8_t, const Bytes& data) { slave.reply(3, data); };
  slave.stuck = true;
  send("0020AA");
  run_for(1ms);
  slave.reply(3, hex("0030CC"));
  send("0020BB");
  run_for(5ms);
  EXPECT_EQ(came(), "0030CC early");
  slave.stuck = false;
  run_for(5ms);
  EXPECT_EQ(came(), "0020AA early");
  EXPECT_EQ(came(), "0020BB");
}

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

TEST_F(MailboxTest, AnEmergencyBetweenIsKeptApart) {
  slave.handler = [this](std::uint8_t, const Bytes& data) {
    slave.reply(3, hex("0010 1082 11 0102030405"));
    slave.reply(3, data);
  };
  send("0020AA");
  run_for(5ms);
  EXPECT_EQ(came(), "0020AA");
  const auto emergency = mailbox.take_emergency();
  ASSERT_TRUE(emergency);
  EXPECT_EQ(emergency->node, 4);
  EXPECT_EQ(emergency->code, 0x8210);
  EXPECT_EQ(emergency->error_register, 0x11);
  EXPECT_EQ(to_hex(emergency->vendor), "01 02 03 04 05");
  EXPECT_FALSE(mailbox.take_emergency());
}

TEST_F(MailboxTest, EmergenciesAreFoundWhileNobodyWaitsAndWhenTheyWereLeftBehind) {
  mailbox.listen(false, now);
  slave.reply(3, hex("0010 1082 11 0000000000"));
  run_for(150ms);
  EXPECT_TRUE(mailbox.take_emergency());
  slave.reply(3, hex("0010 1082 11 0000000000"));
  mailbox.start(now);
  run_for(10ms);
  EXPECT_TRUE(mailbox.take_emergency());
  frames = 0;
  run_for(1s);
  EXPECT_LE(frames, 11) << "ten times a second";
}

TEST_F(MailboxTest, ARefusalOfTheSlaveIsTold) {
  slave.handler = [this](std::uint8_t, const Bytes&) { slave.reply(0, hex("0100 0700")); };
  send("0020AA");
  run_for(5ms);
  EXPECT_EQ(came(), "refused: no memory available");
}

TEST_F(MailboxTest, OtherProtocolsAndDamagedMessagesAreCountedAndLeft) {
  slave.handler = [this](std::uint8_t, const Bytes& data) {
    slave.reply(2, hex("0102030405"));
    slave.reply_raw(hex("FF07 0000 00 13 0030"));
    slave.reply(3, data);
  };
  send("0020AA");
  run_for(5ms);
  EXPECT_EQ(came(), "0020AA");
  EXPECT_EQ(mailbox.statistics().foreign, 1U);
  EXPECT_EQ(mailbox.statistics().damaged, 1U);
}

TEST_F(MailboxTest, AnyNumbersInAnswersDo) {
  for (const auto& numbers : {std::vector<std::uint8_t>{0}, {5}, {7, 1, 3}}) {
    slave.numbers = numbers;
    for (int i = 0; i < 5; ++i) {
      send("0020AA");
      run_for(5ms);
      EXPECT_EQ(came(), "0020AA");
    }
  }
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

TEST(MailboxMessage, AMailboxThatIsTooSmallHoldsItsMessageAllTheSame) {
  EXPECT_EQ(mailbox_bytes(MailboxType::coe, 1, Bytes(10), 3).size(), 16U);
}

TEST(MailboxMessage, EachTextOfARefusalIsItsOwn) {
  EXPECT_EQ(mailbox_error_text(5), "invalid protocol header");
  EXPECT_EQ(mailbox_error_text(99), "reason not listed in ETG.1000.4");
  EXPECT_FALSE(parse_mailbox(hex("0000000000")));
  EXPECT_FALSE(parse_mailbox(hex("010000000003")));
  EXPECT_TRUE(parse_mailbox(hex("000000000003")));
}

}  // namespace
}  // namespace servoctl::ethercat
