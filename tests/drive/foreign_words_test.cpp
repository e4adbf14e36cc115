// Words in the cells of tables as people have them.
#include <gtest/gtest.h>

#include "drive/foreign_words.hpp"

namespace servoctl::drive {
namespace {

TEST(ForeignWords, TypesInAnyCase) {
  EXPECT_EQ(family_type("U16"), "u16");
  EXPECT_EQ(family_type("S32"), "i32");
  EXPECT_EQ(family_type("INTEGER16"), "i16");
}

TEST(ForeignWords, OnlyWholePhrasesAreEffects) {
  EXPECT_EQ(family_effect("At once"), "immediate");
  EXPECT_EQ(family_effect("重新上电生效"), "restart");
  EXPECT_EQ(family_effect("Not immediate"), "Not immediate");
}

}  // namespace
}  // namespace servoctl::drive
