#include "mailbox_fixture.hpp"

namespace servoctl::ethercat {
namespace {

using namespace std::chrono_literals;

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
