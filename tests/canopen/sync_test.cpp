#include "canopen/sync.hpp"

#include <gtest/gtest.h>

#include <string>

#include "base/statistics.hpp"

namespace servoctl::canopen {
namespace {

using namespace std::chrono_literals;

TimePoint at(Duration time) { return TimePoint(10s) + time; }

/// What is sent at this time, in the notation of candump; empty when nothing is.
std::string sent(SyncProducer& producer, Duration time) {
  producer.on_time(at(time));
  const auto frame = producer.take_frame();
  return frame ? can::to_string(*frame) : std::string();
}

TEST(SyncProducer, SendsAtOnceAndThenOnceAPeriod) {
  SyncProducer producer({.period = 10ms}, at(0ms));
  EXPECT_EQ(sent(producer, 0ms), "080#");
  EXPECT_EQ(sent(producer, 9ms), "");
  EXPECT_EQ(producer.deadline(), at(10ms));
  EXPECT_EQ(sent(producer, 11ms), "080#");
  EXPECT_EQ(producer.deadline(), at(20ms)) << "lateness does not add up";
}

TEST(SyncProducer, CountsFromOneToItsLast) {
  SyncProducer producer({.period = 1ms, .last_counter = 3}, at(0ms));
  std::string all;
  for (int i = 0; i < 5; ++i) all += sent(producer, i * 1ms) + " ";
  EXPECT_EQ(all, "080#01 080#02 080#03 080#01 080#02 ");
}

TEST(SyncProducer, TellsWhatItMissedAndDoesNotMakeUpForIt) {
  SyncProducer producer({.period = 1ms}, at(0ms));
  EXPECT_EQ(sent(producer, 5500us), "080#");
  EXPECT_EQ(sent(producer, 5600us), "");
  EXPECT_EQ(producer.missed(), 5U);
  EXPECT_EQ(sent(producer, 6ms), "080#");
}

TEST(Statistics, TellWhatNumbersHaveInCommon) {
  Statistics statistics;
  EXPECT_EQ(statistics.deviation(), 0);
  for (const double number : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) statistics.add(number);
  EXPECT_EQ(statistics.count(), 8U);
  EXPECT_EQ(statistics.least(), 2);
  EXPECT_EQ(statistics.greatest(), 9);
  EXPECT_DOUBLE_EQ(statistics.mean(), 5);
  EXPECT_DOUBLE_EQ(statistics.deviation(), 2);
}

}  // namespace
}  // namespace servoctl::canopen
