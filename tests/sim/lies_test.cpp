#include <gtest/gtest.h>

#include "sim/answer_way.hpp"
#include "sim/cell_spec.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

constexpr TimePoint kNow{1s};

can::Frame answer() { return can::parse_frame("581#4B41600050020000").value(); }

TEST(Lies, OnlyTheWordsOfTheWireAreTaken) {
  const auto spec = parse_cell_spec("gsd600@1?lie=late,short", "example").value();
  EXPECT_EQ(lies_of(spec, spec.options[0], kCanLies).value().size(), 2U);
  const auto wrong = parse_cell_spec("gsd600@1?lie=late,wkc", "example").value();
  const auto refused = lies_of(wrong, wrong.options[0], kCanLies);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::usage);
  EXPECT_NE(refused.error().message.text().find("unconfirmed"), std::string::npos)
      << refused.error().message.text();
}

TEST(Lies, EverySecondAnswerIsLateAndNoneOvertakesIt) {
  WireFaults faults;
  add_lie(faults, "late");
  AnswerWay way;
  way.put(answer(), faults, kNow);
  way.put(answer(), faults, kNow + 500ms);
  EXPECT_FALSE(way.take(kNow + 600ms));
  EXPECT_EQ(way.deadline(), kNow + 700ms);
  EXPECT_TRUE(way.take(kNow + 700ms));
  EXPECT_TRUE(way.take(kNow + 700ms));
}

TEST(Lies, AnswersAreDoubledChangedAndCut) {
  WireFaults faults;
  for (const auto* word : {"twice", "wrong-index", "short"}) add_lie(faults, word);
  AnswerWay way;
  way.put(answer(), faults, kNow);
  for (int copy = 0; copy < 2; ++copy) {
    const auto came = way.take(kNow);
    ASSERT_TRUE(came);
    EXPECT_EQ(can::to_string(*came), "581#4B426000");
  }
  EXPECT_FALSE(way.take(kNow));
}

TEST(Lies, AnAbortNamesNoObjectAndAWriteIsNotConfirmed) {
  WireFaults faults;
  for (const auto* word : {"abort-index", "unconfirmed"}) add_lie(faults, word);
  AnswerWay way;
  way.put(can::parse_frame("581#6040600000000000").value(), faults, kNow);
  way.put(can::parse_frame("581#8040600011000906").value(), faults, kNow);
  EXPECT_EQ(can::to_string(*way.take(kNow)), "581#8000000011000906");
  EXPECT_FALSE(way.take(kNow));
}

}  // namespace
}  // namespace servoctl::sim
