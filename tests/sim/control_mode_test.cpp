// A simulated drive obeys the controlword only in the control mode that belongs to its bus.
#include "sim_support.hpp"

namespace servoctl::sim {
namespace {

using namespace std::chrono_literals;

/// 6040h = 6, 7, 15.
constexpr unsigned kReady = 0x0231;

struct Family {
  const char* name;
  const char* mode;     ///< The parameter of the control mode.
  const char* needed;   ///< Its value for CANopen.
  const char* other;    ///< Another one.
  unsigned statusword;  ///< In the other: bit 9 (remote) is 0 where the family has it.
};
constexpr Family kControlled[] = {{"gsd600", "Pn0000", "8", "0", 0x0070},
                                  {"da200", "P0.03", "7", "0", 0x0050},
                                  {"ts", "Fn_00", "20", "2", 0x0050}};

class ControlMode : public DrivenTest, public testing::WithParamInterface<Family> {
 protected:
  void boot_in(const char* value) {
    build(std::string(GetParam().name) + "@1?panel=" + GetParam().mode + "=" + value);
    ASSERT_EQ(next(100ms), "701#00");
  }
};

TEST_P(ControlMode, ThatIsNotOfTheBusObeysNoControlword) {
  boot_in(GetParam().other);
  enable("3");
  EXPECT_EQ(status(), GetParam().statusword);
  EXPECT_FALSE(drive().model().is_moving());
}

TEST_P(ControlMode, OfTheBusObeys) {
  boot_in(GetParam().needed);
  write({0x6040, 0}, "6");
  EXPECT_EQ(status() & 0x6FU, kReady & 0x6FU);
}

TEST_P(ControlMode, HoldsUntilTheRestart) {
  boot_in(GetParam().needed);
  const auto& store = profile().rules.store;
  if (!store.unlock.empty())
    write(*profile().parameter(store.unlock)->object, std::to_string(*store.unlock_open));
  write(*profile().parameter(GetParam().mode)->object, GetParam().other);
  enable("3");
  EXPECT_EQ(status() & 0x6FU, 0x27U) << "the value in force is that of the start";
}

INSTANTIATE_TEST_SUITE_P(Families, ControlMode, testing::ValuesIn(kControlled),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_F(DrivenTest, AsDeliveredTheTsIsNotInCanopenMode) {
  build("ts@1");
  ASSERT_EQ(next(100ms), "701#00");
  enable("3");
  EXPECT_EQ(status(), 0x0050U) << "Fn_00 = 2 from the factory (232, 237); CANopen needs 20 (1869)";
}

}  // namespace
}  // namespace servoctl::sim
