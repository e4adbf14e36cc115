// Slaves that are switched off while a scan looks for them.
#include "lss_world.hpp"

namespace servoctl::session {
namespace {

using namespace std::chrono_literals;

class LssLeaving : public LssWorld {};

/// Nobody is a result only where nobody has answered.
TEST_F(LssLeaving, SlavesThatLeaveHalfWayAreNoEmptyScan) {
  build("sv2@255,da200@255?lss");
  const auto scan = [&] { return LssDialogue(*session, 20ms).scan(); };
  ASSERT_TRUE(scan());
  const int requests = hooks.requests;
  constexpr int kFirstAnswered = 2;
  constexpr int kLastConfirmed = 8;
  for (int i = kFirstAnswered; i < requests - kLastConfirmed; i += 11) {
    hooks = {};
    hooks.before_request = [&](int number) {
      for (const auto& drive : cell.drives) drive->wire_faults().silent = number >= i;
    };
    const auto found = scan();
    EXPECT_FALSE(found) << i << ": " << (found ? found->size() : 0) << " slaves";
  }
}

}  // namespace
}  // namespace servoctl::session
