// The mailbox of a simulated slave: full bits, counters, repeats, errors (ETG.1000.4, clauses 5.6 and 6.7).
#include "esc_support.hpp"

namespace servoctl::sim {
namespace {

using std::chrono::milliseconds;

/// The device type (1000h), asked for and answered.
constexpr const char* kReadType = "40 0010 00 00000000";
constexpr const char* kType = "00 30 43 00 10 00 92 01 04 00";

class EscMailboxTest : public EscTest {
 protected:
  void SetUp() override {
    build(1);
    go_to_pre_op();
  }
  static Bytes sdo_message(std::string_view request) {
    auto out = hex("0020");
    const auto body = hex(request);
    out.insert(out.end(), body.begin(), body.end());
    return out;
  }
};

TEST_F(EscMailboxTest, ARequestGoesInAndItsAnswerComesOutByteForByte) {
  Bytes whole = hex("0A00 0000 00 13 0020 40 0010 00 00000000");
  whole.resize(256);
  EXPECT_EQ(show(0x080D, 1), "00");
  EXPECT_EQ(write(0x1000, whole), 1);
  EXPECT_EQ(show(0x0805, 1), "00");  // It was taken at once,
  EXPECT_EQ(show(0x080D, 1), "08");  // and answered.
  const auto got = read(0x1400, 256);
  EXPECT_EQ(got.counter, 1);
  EXPECT_EQ(to_hex(ByteSpan(got.data).first(18)), "0A 00 00 00 00 13 00 30 43 00 10 00 92 01 04 00 00 00");
  EXPECT_EQ(show(0x080D, 1), "00");
  EXPECT_EQ(read(0x1400, 256).counter, 0);
}

TEST_F(EscMailboxTest, OnlyTheWholeMailboxCounts) {
  Bytes whole = hex("0A00 0000 00 13 0020 40 0010 00 00000000");
  EXPECT_EQ(write(0x1000, whole), 1);  // Its last byte is missing.
  EXPECT_EQ(show(0x0805, 1), "00");
  EXPECT_EQ(fetch(), "");
  EXPECT_EQ(write(0x10FF, "00"), 1);
  EXPECT_EQ(read(0x1404, 4).counter, 0);  // Not from the start.
  EXPECT_EQ(read(0x1400, 4).counter, 1);
  EXPECT_EQ(show(0x080D, 1), "08");
  EXPECT_EQ(read(0x1404, 252).counter, 1);
  EXPECT_EQ(show(0x080D, 1), "00");
  EXPECT_EQ(write(0x1001, whole), 0);
}

TEST_F(EscMailboxTest, EachSideHasOneDirection) {
  EXPECT_EQ(write(0x1400, Bytes(256, 0)), 0);
  slave().faults().mailbox_stays_full = true;
  EXPECT_EQ(post(sdo_message(kReadType)), 1);
  EXPECT_EQ(read(0x1000, 256).counter, 0);
}

TEST_F(EscMailboxTest, AMailboxThatStaysFullTakesNoMore) {
  slave().faults().mailbox_stays_full = true;
  EXPECT_EQ(post(sdo_message(kReadType)), 1);
  EXPECT_EQ(show(0x0805, 1), "08");
  EXPECT_EQ(post(sdo_message(kReadType)), 0);
  EXPECT_EQ(fetch(), "");
  slave().faults().mailbox_stays_full = false;
  run(milliseconds(1));
  EXPECT_EQ(fetch_data(), kType);
}

TEST_F(EscMailboxTest, ARequestWaitsUntilTheAnswerToTheLastIsOut) {
  EXPECT_EQ(post(sdo_message(kReadType)), 1);
  EXPECT_EQ(post(sdo_message("40 0110 00 00000000")), 1);  // Its answer waits behind the first,
  EXPECT_EQ(post(sdo_message("40 1810 01 00000000")), 1);  // and this one in its mailbox.
  EXPECT_EQ(show(0x0805, 1), "08");
  EXPECT_EQ(fetch_data(), kType);
  EXPECT_EQ(fetch_data(), "00 30 4F 01 10 00 00 00 00 00");
  EXPECT_EQ(fetch_data(), "00 30 43 18 10 01 53 56 44 00");
}

TEST_F(EscMailboxTest, ItsCountersGoFromOneToSevenAndRound) {
  std::string counters;
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(post(sdo_message(kReadType)), 1);
    counters += fetch().substr(15, 1);
  }
  EXPECT_EQ(counters, "123456712");
  slave().faults().uncounted_answers = true;
  EXPECT_EQ(post(sdo_message(kReadType)), 1);
  EXPECT_EQ(fetch().substr(15, 2), "03");
}

TEST_F(EscMailboxTest, ARequestThatComesTwiceIsDoneOnce) {
  EXPECT_EQ(post_raw(0x53, sdo_message(kReadType)), 1);
  EXPECT_EQ(fetch_data(), kType);
  EXPECT_EQ(post_raw(0x53, sdo_message(kReadType)), 1);
  EXPECT_EQ(fetch(), "");
  EXPECT_EQ(post_raw(0x63, sdo_message(kReadType)), 1);
  EXPECT_EQ(fetch_data(), kType);
  for (int i = 0; i < 2; ++i) {  // Without a counter none is a repetition.
    EXPECT_EQ(post_raw(0x03, sdo_message(kReadType)), 1);
    EXPECT_EQ(fetch_data(), kType);
  }
  EXPECT_EQ(post_raw(0x63, sdo_message(kReadType)), 1);  // One stood between.
  EXPECT_EQ(fetch_data(), kType);
}

TEST_F(EscMailboxTest, AnAnswerThatWasLostComesAgain) {
  EXPECT_EQ(post(sdo_message(kReadType)), 1);
  const auto answer = fetch();
  EXPECT_EQ(write(0x080E, "03"), 1);
  EXPECT_EQ(show(0x080F, 1), "02");
  EXPECT_EQ(fetch(), answer);
  EXPECT_EQ(write(0x080E, "01"), 1);
  EXPECT_EQ(show(0x080F, 1), "00");
  EXPECT_EQ(fetch(), answer);
  EXPECT_EQ(write(0x080E, "01"), 1);  // Not changed: nothing is asked for.
  EXPECT_EQ(fetch(), "");
}

TEST_F(EscMailboxTest, WhatLiesUnreadComesAfterTheRepeatedMessage) {
  EXPECT_EQ(post(sdo_message(kReadType)), 1);
  const auto first = fetch();
  EXPECT_EQ(post(sdo_message("40 0110 00 00000000")), 1);
  EXPECT_EQ(write(0x080E, "03"), 1);
  EXPECT_EQ(fetch(), first);
  EXPECT_EQ(fetch_data(), "00 30 4F 01 10 00 00 00 00 00");
  EXPECT_EQ(fetch(), "");
}

TEST_F(EscMailboxTest, ARepeatBeforeAnythingWasReadIsConfirmed) {
  EXPECT_EQ(write(0x080E, "03"), 1);
  EXPECT_EQ(show(0x080E, 2), "03 02");
  EXPECT_EQ(fetch(), "");
  slave().faults().no_repeat = true;
  EXPECT_EQ(sdo(kReadType), kType);
  EXPECT_EQ(write(0x080E, "01"), 1);
  EXPECT_EQ(show(0x080E, 2), "01 00");
  EXPECT_EQ(fetch(), "");
}

TEST_F(EscMailboxTest, WhatItDoesNotUnderstandIsAnswered) {
  EXPECT_EQ(post(hex("0020 40 0010 00 00000000"), 4), 1);  // FoE.
  EXPECT_EQ(fetch(), "04 00 00 00 00 10 01 00 02 00");
  EXPECT_EQ(post(hex("0000 40 0010 00 00000000")), 1);  // Service 0.
  EXPECT_EQ(fetch_data(), "01 00 04 00");
  EXPECT_EQ(post(hex("0080 01 00 0000 0100")), 1);  // SDO information, which it does not have.
  EXPECT_EQ(fetch_data(), "01 00 04 00");
  EXPECT_EQ(post(hex("0020 40 0010 00 000000")), 1);
  EXPECT_EQ(fetch_data(), "01 00 06 00");
  Bytes whole = hex("0A00 0000 01 23 0020 40 0010 00 00000000");  // A channel.
  whole.resize(256);
  EXPECT_EQ(write(0x1000, whole), 1);
  EXPECT_EQ(fetch_data(), "01 00 03 00");
  whole[4] = 0;
  whole[5] = 0x33;
  whole[0] = 251;  // Longer than the mailbox.
  EXPECT_EQ(write(0x1000, whole), 1);
  EXPECT_EQ(fetch_data(), "01 00 08 00");
  EXPECT_EQ(post(hex("0100 0200"), 0), 1);  // An error is not answered.
  EXPECT_EQ(fetch(), "");
  EXPECT_EQ(sdo(kReadType), kType);
}

TEST_F(EscMailboxTest, AnAnswerComesLate) {
  slave().faults().answer_delay = milliseconds(40);
  EXPECT_EQ(sdo(kReadType), "");
  run(milliseconds(39));
  EXPECT_EQ(show(0x080D, 1), "00");
  run(milliseconds(1));
  EXPECT_EQ(show(0x080D, 1), "08");
  EXPECT_EQ(fetch_data(), kType);
}

TEST_F(EscMailboxTest, AnAnswerNeverComes) {
  slave().faults().unanswered = 1;
  EXPECT_EQ(sdo(kReadType), "");
  run(std::chrono::seconds(10));
  EXPECT_EQ(fetch(), "");
  EXPECT_EQ(sdo(kReadType), kType);
}

TEST_F(EscMailboxTest, AnEmergencyComesBetweenRequestAndAnswer) {
  slave().faults().emergencies = 1;
  EXPECT_EQ(sdo(kReadType), "00 10 00 FF 00 00 00 00 00 00");
  EXPECT_EQ(fetch_data(), kType);
  EXPECT_EQ(sdo(kReadType), kType);
}

TEST_F(EscMailboxTest, AFaultOfTheDriveIsTold) {
  slave().model().raise_fault(0x2310, {1, 2, 3, 4, 5}, now_);
  run(milliseconds(1));
  EXPECT_EQ(fetch().substr(0, 41), "0A 00 00 00 00 13 00 10 10 23 03 01 02 03");
}

TEST_F(EscMailboxTest, InInitThereIsNone) {
  EXPECT_EQ(post(sdo_message(kReadType)), 1);
  EXPECT_EQ(request(1), "01 00 00 00 00 00");
  EXPECT_EQ(post(sdo_message(kReadType)), 1);
  EXPECT_EQ(show(0x0805, 1), "08");
  EXPECT_EQ(write(0x0806, "00"), 1);
  EXPECT_EQ(write(0x080E, "00"), 1);
  counter_ = 0;
  go_to_pre_op();
  EXPECT_EQ(fetch(), "");
  EXPECT_EQ(sdo(kReadType), kType);
}

}  // namespace
}  // namespace servoctl::sim
