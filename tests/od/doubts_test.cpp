#include "od/doubts.hpp"

#include <gtest/gtest.h>

namespace servoctl::od {
namespace {

TEST(Doubts, AreFieldsWithTheirLines) {
  const auto marks = parse_marks("default 938 3288;min");
  ASSERT_TRUE(marks);
  ASSERT_EQ(marks->size(), 2U);
  EXPECT_EQ((*marks)[0], (Mark{"default", {938, 3288}}));
  EXPECT_EQ((*marks)[1], (Mark{"min", {}}));
  EXPECT_EQ(to_text(*marks), "default (lines 938, 3288), min");
}

TEST(Doubts, ThatAreNoMarksAreRefused) {
  for (const auto* text : {";", "min;;max", "12", "min x", "min 0", "min  5", "min;min 5"})
    EXPECT_FALSE(parse_marks(text)) << text;
}

TEST(Doubts, AreAboutAFieldWhetherAssumedOrContradicted) {
  const Doubts doubts{{{"min", {}}}, {{"max", {5, 6}}}};
  EXPECT_TRUE(doubts.about("min"));
  EXPECT_TRUE(doubts.about("max"));
  EXPECT_FALSE(doubts.about("m"));
  EXPECT_EQ(doubts.sign(), "?!");
  EXPECT_EQ(Doubts{}.sign(), "");
}

}  // namespace
}  // namespace servoctl::od
