// A simulated drive acts on its switches as its parameters say.
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

constexpr unsigned kAttained = 1U << 12U;

class MaskedSwitch : public DrivenTest {
 protected:
  void home(std::string_view method) {
    write({0x6060, 0}, "6");
    write({0x6098, 0}, method);
    for (const auto* word : {"6", "7", "15", "31"}) write({0x6040, 0}, word);
  }
  void restart() {
    send("000#8101");
    wait(500ms);
  }
};

TEST_F(MaskedSwitch, IsNotFoundByHoming) {
  boot("gsd600");
  home("17");
  wait(20s);
  EXPECT_EQ(status() & kAttained, 0U) << "Pn0603 = 3 from the factory: LSN is on whatever its switch says";
}

TEST_F(MaskedSwitch, StaysMaskedUntilTheDriveRestarts) {
  boot("gsd600");
  write({0x2003, 4}, "0");
  home("17");
  wait(20s);
  EXPECT_EQ(status() & kAttained, 0U);
  restart();
  home("17");
  wait(20s);
  EXPECT_NE(status() & kAttained, 0U);
}

TEST_F(MaskedSwitch, IsNotFoundWhereNoInputHasItsFunction) {
  boot("gsd600");
  write({0x2003, 4}, "0");
  write({0x2003, 0x0E}, "0");
  restart();
  home("17");
  wait(20s);
  EXPECT_EQ(status() & kAttained, 0U) << "Pn0613 was LSN";
  write({0x2003, 0x0B}, "4");
  restart();
  home("17");
  wait(20s);
  EXPECT_NE(status() & kAttained, 0U) << "DI0 is LSN";
}

TEST_F(MaskedSwitch, ThatIsObeyedStopsAMotion) {
  boot("gsd600");
  write({0x2003, 4}, "0");
  restart();
  enable("3");
  write({0x60FF, 0}, "131072");
  wait(8s);
  EXPECT_EQ(read({0x606C, 0}), 0);
  EXPECT_LT(read({0x6064, 0}), 5 * 131072);
}

TEST_F(MaskedSwitch, OfAPanelParameterIsMaskedAsDelivered) {
  boot("sv2");
  home("17");
  wait(20s);
  EXPECT_EQ(status() & 0x3400U, 0x1000U) << "still looking for it";
}

TEST_F(MaskedSwitch, OfAPanelParameterFollowsThePanel) {
  boot("sv2");
  drive().panel() = {{"PA-20", 0}, {"PA-74", 1}};
  home("17");
  wait(20s);
  EXPECT_EQ(status() & 0x3400U, 0x0400U) << "bit 12 is 0 when it is done";
}

}  // namespace
}  // namespace servoctl::sim
