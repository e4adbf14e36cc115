#include "can/slcan_watch.hpp"

#include <gtest/gtest.h>

namespace servoctl::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using WatchState = SlcanWatch::State;

constexpr TimePoint kOpened{seconds(100)};

TEST(SlcanWatchTest, AsksForFlagsOnceASecondAndLeavesTheFirstOnesOut) {
  SlcanWatch watch(true, true, kOpened);
  EXPECT_EQ(watch.take_question(kOpened), "F\r");
  EXPECT_EQ(watch.take_question(kOpened), "");
  EXPECT_FALSE(watch.on_flags(kOpened + milliseconds(2))) << "they are of a time before";
  EXPECT_EQ(watch.due(), kOpened + seconds(1));
  EXPECT_EQ(watch.take_question(watch.due()), "F\r");
  EXPECT_TRUE(watch.on_flags(watch.due()));
  EXPECT_TRUE(watch.has_flags());
}

TEST(SlcanWatchTest, AnAdapterThatSaysNothingAnyMoreIsSilentAfterThreeQuestions) {
  SlcanWatch watch(true, true, kOpened);
  (void)watch.take_question(kOpened);
  (void)watch.on_flags(kOpened);
  for (int i = 1; i <= 3; ++i) EXPECT_EQ(watch.take_question(kOpened + seconds(i)), "F\r");
  EXPECT_EQ(watch.state(), WatchState::fine);
  EXPECT_EQ(watch.take_question(kOpened + seconds(4)), "");
  EXPECT_EQ(watch.state(), WatchState::silent);
}

TEST(SlcanWatchTest, FramesAreALifeSignOfOneThatAnswersNoQuestion) {
  SlcanWatch watch(true, false, kOpened);
  (void)watch.take_question(kOpened);
  (void)watch.on_flags(kOpened);
  for (int i = 1; i <= 9; ++i) {
    (void)watch.take_question(kOpened + seconds(i));
    watch.on_bytes(kOpened + seconds(i) + milliseconds(500));
  }
  EXPECT_EQ(watch.state(), WatchState::fine);
}

TEST(SlcanWatchTest, OneThatRefusesTheFlagsItHadHasStartedAnew) {
  SlcanWatch watch(true, true, kOpened);
  (void)watch.take_question(kOpened);
  (void)watch.on_flags(kOpened);
  EXPECT_EQ(watch.take_question(kOpened + seconds(1)), "F\r");
  EXPECT_TRUE(watch.on_answer(kOpened + seconds(1)));
  EXPECT_EQ(watch.state(), WatchState::fine) << "it may have been the late refusal of a frame";
  EXPECT_EQ(watch.take_question(watch.due()), "F\r");
  EXPECT_TRUE(watch.on_answer(watch.due()));
  EXPECT_EQ(watch.state(), WatchState::restarted);
}

TEST(SlcanWatchTest, OneWithoutFlagsIsAskedForItsVersionWhenItIsQuiet) {
  SlcanWatch watch(true, true, kOpened);
  (void)watch.take_question(kOpened);
  EXPECT_TRUE(watch.on_answer(kOpened));
  EXPECT_EQ(watch.state(), WatchState::fine);
  watch.on_bytes(kOpened + seconds(1));
  EXPECT_EQ(watch.take_question(kOpened + seconds(2)), "") << "it was heard a second ago";
  EXPECT_EQ(watch.take_question(watch.due()), "V\r");
  watch.on_bytes(kOpened + seconds(3));
  watch.on_version();
  auto time = kOpened;
  for (int i = 0; i < 9 && watch.due() != kNever; ++i) {
    time = watch.due();
    (void)watch.take_question(time);
  }
  EXPECT_EQ(watch.state(), WatchState::silent);
  EXPECT_LE(time, kOpened + seconds(9));
}

TEST(SlcanWatchTest, OneWithNeitherIsAskedNothing) {
  SlcanWatch watch(false, false, kOpened);
  EXPECT_EQ(watch.due(), kNever);
  EXPECT_EQ(watch.take_question(kOpened + seconds(100)), "");
}

}  // namespace
}  // namespace servoctl::can
