#include "session/protection.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace servoctl::session {
namespace {

class ProtectionTest : public testing::Test {
 protected:
  std::vector<Care> told;
  Protection protection{[this](Care worst) { told.push_back(worst); }};
};

TEST_F(ProtectionTest, TellsTheWorstOfWhatIsHeldWheneverItChanges) {
  Protection::Hold first(&protection, Care::guarded);
  {
    const Protection::Hold second(&protection, Care::guarded);
    const Protection::Hold third(&protection, Care::energised);
    const Protection::Hold nothing(&protection, Care::none);
  }
  const Protection::Hold left(&protection, Care::energised);
  first.release();
  first.release();
  EXPECT_EQ(told, (std::vector{Care::guarded, Care::energised}));
  EXPECT_EQ(protection.worst(), Care::energised);
}

TEST_F(ProtectionTest, AHoldThatIsPassedOnIsGivenBackOnce) {
  {
    Protection::Hold first(&protection, Care::energised);
    Protection::Hold second = std::move(first);
    Protection::Hold third;
    third = std::move(second);
    EXPECT_EQ(protection.worst(), Care::energised);
  }
  EXPECT_EQ(told, (std::vector{Care::energised, Care::none}));
}

TEST_F(ProtectionTest, HoldsAsLongAsOneDriveIsEnergised) {
  EnergisedNodes nodes(&protection);
  nodes.insert(1);
  nodes.insert(2);
  nodes.erase(1);
  nodes.erase(7);
  EXPECT_EQ(protection.worst(), Care::energised);
  EnergisedNodes elsewhere = std::move(nodes);
  EXPECT_EQ(protection.worst(), Care::energised);
  elsewhere.erase(2);
  EXPECT_EQ(told, (std::vector{Care::energised, Care::none}));
}

}  // namespace
}  // namespace servoctl::session
