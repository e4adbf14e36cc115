// What a scan for LSS slaves tells of itself while it goes on.
#include <algorithm>
#include <set>

#include "lss_world.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

class LssScanning : public LssWorld {};

/// How many there are nobody knows; how many were found, and how much of the next identity, is so at each
/// step.
TEST_F(LssScanning, TellsWhereItIs) {
  build("sv2@255,sv2@255,gsd600@255?lss");
  LssDialogue lss(*session, 50ms);
  std::vector<LssProgress> told;
  lss.on_progress([&](const LssProgress& at) { told.push_back(at); });
  ASSERT_TRUE(lss.scan());
  ASSERT_GT(told.size(), 128U);
  std::set<std::size_t> found;
  for (const auto& at : told) {
    found.insert(at.found);
    EXPECT_LT(at.known, at.bits);
    EXPECT_EQ(at.bits, 128U);
    EXPECT_FALSE(at.again);
  }
  EXPECT_EQ(found, (std::set<std::size_t>{0, 1, 2, 3}));
  told.clear();
  ASSERT_TRUE(lss.search({0x445653, 1, 0, 0}, {0x445653, 1, 0xFFFF'FFFF, 0xFFFF'FFFF}));
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.front().known, 64U) << "vendor and product";
  EXPECT_EQ(std::max_element(told.begin(), told.end(),
                             [](const auto& a, const auto& b) { return a.known < b.known; })
                ->known,
            128U);
}

}  // namespace
}  // namespace servoctl::session
