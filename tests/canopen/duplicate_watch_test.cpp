#include "canopen/duplicate_watch.hpp"

#include "transcript.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

constexpr auto kAskType = "> 601#4000100000000000";
constexpr auto kAskStatus = "> 601#4041600000000000";
constexpr auto kAskMode = "> 601#4061600000000000";
constexpr auto kStatus = "< 581#4B41600050020000";
constexpr auto kMode = "< 581#4F61600003000000";

class DuplicateWatchTest : public testing::Test {
 protected:
  /// `> …` is sent by this program, `< …` is received, `+ 5ms` lets time pass; a frame takes 1 ms.
  void play(std::initializer_list<std::string_view> lines) {
    for (const auto line : lines) {
      const auto rest = line.substr(2);
      if (line.front() == '+') {
        now += parse_duration(rest).value();
        continue;
      }
      now += 1ms;
      if (line.front() == '>')
        watch.on_sent(frame(rest), now);
      else
        watch.on_frame(frame(rest), now);
    }
  }
  std::string noticed() const { return watch.noticed(1); }
  DuplicateWatch watch;
  TimePoint now{1s};
};

TEST_F(DuplicateWatchTest, IsCertainWhenWhatNeverChangesIsAnsweredInTwoWays) {
  play({"> 601#4018100400000000", "< 581#4318100401000000"});
  EXPECT_EQ(noticed(), "");
  play({"< 581#4318100402000000"});
  EXPECT_EQ(noticed(), "0x1018:4 was answered by 0x00000001 and by 0x00000002");
  const auto event = watch.take_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->node, 1);
  EXPECT_EQ(std::get<NodeEvent::Doubled>(event->what).by, noticed());
  EXPECT_FALSE(watch.take_event()) << "told once";
}

TEST_F(DuplicateWatchTest, IsCertainWhenAnIdentityChangesFromReadToRead) {
  play({kAskType, "< 581#4300100092010200", kAskType, "< 581#4300100092010200"});
  EXPECT_EQ(noticed(), "");
  play({"+ 60s", kAskType, "< 581#4300100000000300"});
  EXPECT_EQ(noticed(), "0x1000:0 was answered by 0x00020192 and by 0x00030000");
}

TEST_F(DuplicateWatchTest, TakesAnotherIdentityBehindABootUpForAnotherDrive) {
  play({kAskType, "< 581#4300100092010200", "+ 60s", "< 701#00", kAskType, "< 581#4300100000000300"});
  EXPECT_EQ(noticed(), "");
}

TEST_F(DuplicateWatchTest, ComparesTheSizesOfNames) {
  play({"> 601#4008100000000000", "< 581#4108100006000000", "< 581#4108100009000000"});
  EXPECT_EQ(noticed(), "0x1008:0 was answered by a text of 6 bytes and by a text of 9 bytes");
}

TEST_F(DuplicateWatchTest, TakesNoValueThatChangesForAProof) {
  play({kAskStatus, kStatus, "< 581#4B41600037020000"});
  EXPECT_EQ(noticed(), "");
  EXPECT_TRUE(watch.is_suspect(1));
}

TEST_F(DuplicateWatchTest, TakesOneDoubledFrameForNoProof) {
  play({kAskStatus, kStatus, kStatus, kAskMode, kMode, kAskStatus, kStatus, kAskMode, kMode});
  EXPECT_EQ(noticed(), "");
  EXPECT_TRUE(watch.is_suspect(1));
  play({kAskStatus, kStatus, kAskMode, kMode, kAskStatus, kStatus, kAskMode, kMode, kAskStatus, kStatus});
  EXPECT_FALSE(watch.is_suspect(1)) << "long ago";
}

TEST_F(DuplicateWatchTest, IsCertainWhenThreeOfEightAnswersCameTwice) {
  play({kAskStatus, kStatus, kStatus, kAskMode, kMode, kMode, kAskStatus, kStatus});
  EXPECT_EQ(noticed(), "");
  play({kStatus});
  EXPECT_EQ(noticed(), "3 of its last 3 SDO responses came twice");
}

TEST_F(DuplicateWatchTest, CountsSecondAnswersThatComeWhileTheNextRequestWaits) {
  play({kAskStatus, kStatus, kAskMode, kStatus, kMode, "> 601#400F100000000000", kMode,
        "< 581#4F0F100001000000", kAskStatus, "< 581#4F0F100001000000"});
  EXPECT_NE(noticed(), "");
}

TEST_F(DuplicateWatchTest, TakesOneAnswerTooManyWhileTheSameObjectIsPolledForOne) {
  // The second answer to the first request stands for that to the next, and so on.
  play({kAskStatus, kStatus, kAskStatus, kStatus, "< 581#4B41600037020000", kAskStatus,
        "< 581#4B41600037020000", kAskStatus, "< 581#4B41600037020000"});
  EXPECT_EQ(noticed(), "");
}

TEST_F(DuplicateWatchTest, ForgivesTheLateAnswersOfRequestsThatWereGivenUp) {
  for (int i = 0; i < 5; ++i)
    play({kAskStatus, kStatus, kAskStatus, "+ 500ms", "> 601#8041600000000405", kAskStatus, "+ 500ms",
          "> 601#8041600000000405", kStatus, kStatus});
  EXPECT_EQ(noticed(), "");
  EXPECT_FALSE(watch.is_suspect(1));
}

TEST_F(DuplicateWatchTest, CountsWhatOtherMastersAsk) {
  for (int i = 0; i < 5; ++i) play({kAskStatus, "< 601#4041600000000000", kStatus, kStatus});
  EXPECT_EQ(noticed(), "");
}

TEST_F(DuplicateWatchTest, CountsNoAnswersToWhatNobodyWasHeardToAsk) {
  for (int i = 0; i < 5; ++i) play({kStatus, kMode, kStatus, kMode});
  EXPECT_EQ(noticed(), "");
}

TEST_F(DuplicateWatchTest, CountsSegmentsOfOneTransferOnce) {
  for (int i = 0; i < 4; ++i)
    play({"> 601#4008100000000000", "< 581#4108100009000000", "> 601#6000000000000000",
          "< 581#0041424344454647", "> 601#7000000000000000", "< 581#1B48490000000000"});
  EXPECT_EQ(noticed(), "");
  EXPECT_FALSE(watch.is_suspect(1));
}

TEST_F(DuplicateWatchTest, LeavesBlockTransfersOut) {
  play({"> 601#4008100000000000", "< 581#4108100009000000", "> 601#6000000000000000",
        "< 581#0041424344454647"});
  for (int i = 0; i < 4; ++i) {
    play({"+ 2s", kAskStatus, kStatus});
    // Upload: segments carry any byte where others have their specifier.
    play({"> 601#A408100004000000", "< 581#C608100015000000", "> 601#A300000000000000",
          "< 581#4108100061626364", "< 581#6065666768696A6B", "< 581#836C6D6E6F707172",
          "> 601#A203040000000000", "< 581#C1CDAB0000000000", "> 601#A100000000000000", kStatus});
    // Download.
    play({"> 601#C650100115000000", "< 581#A450100104000000", "> 601#4061626364656667",
          "> 601#60686970717273AA", "> 601#8361626364656667", "< 581#A203040000000000",
          "> 601#D1CDAB0000000000", "< 581#A100000000000000", "< 581#A100000000000000", kStatus});
  }
  EXPECT_EQ(noticed(), "");
  play({"+ 1s", kAskStatus, kStatus, kStatus, kAskMode, kMode, kMode, kAskStatus, kStatus, kStatus});
  EXPECT_NE(noticed(), "") << "and counts again behind them";
}

TEST_F(DuplicateWatchTest, NoticesTwoBootUpsThatNobodyAskedFor) {
  play({"< 701#00", "+ 100ms", "< 701#00"});
  EXPECT_EQ(noticed(), "two boot-ups within 101 ms, unless one node keeps restarting");
}

TEST_F(DuplicateWatchTest, TakesResetsDoubledFramesAndSlowRestartsForOneNode) {
  play({"< 701#00", "> 000#8201", "+ 100ms", "< 701#00", "< 000#8100", "+ 100ms", "< 701#00", "+ 600ms",
        "< 701#00"});
  now -= 1ms;
  play({"< 701#00"});
  EXPECT_EQ(noticed(), "");
}

TEST_F(DuplicateWatchTest, NoticesTwoBootUpsAfterOneReset) {
  play({"> 000#8201", "+ 100ms", "< 701#00", "+ 30ms", "< 701#00"});
  EXPECT_EQ(noticed(), "two boot-ups within 31 ms, unless one node keeps restarting");
}

TEST_F(DuplicateWatchTest, KnowsItOfTheNodeAloneUntilItIsToForget) {
  play({"< 701#00", "+ 100ms", "< 701#00"});
  EXPECT_EQ(watch.noticed(2), "");
  play({"+ 10s", "< 701#00"});
  EXPECT_NE(noticed(), "") << "a restart of one of the two proves nothing";
  watch.forget(1);
  EXPECT_EQ(noticed(), "");
}

}  // namespace
}  // namespace servoctl::canopen
