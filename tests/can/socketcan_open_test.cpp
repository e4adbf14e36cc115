#include <gtest/gtest.h>

#include <algorithm>

#include "can/socketcan.hpp"

namespace servoctl::can {
namespace {

TEST(OpenSocketCan, RefusesANameThatNoInterfaceCanHave) {
  for (const auto* name : {"", "sixteencharsname", "../can0"}) {
    const auto bus = open_socketcan(name);
    ASSERT_FALSE(bus) << name;
    EXPECT_EQ(bus.error().code, Errc::usage) << name;
  }
}

TEST(OpenSocketCan, SaysWhatToDoWhenThereIsNoSuchInterface) {
  const auto bus = open_socketcan("nosuchcan7");
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().code, Errc::bus);
  EXPECT_NE(bus.error().message.text().find("nosuchcan7"), std::string::npos);
  EXPECT_NE(bus.error().hint.text().find("sudo"), std::string::npos);
}

TEST(CanInterfaces, LeaveOutOtherNetworks) {
  const auto names = can_interfaces();
  EXPECT_EQ(std::count(names.begin(), names.end(), "lo"), 0);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
}

}  // namespace
}  // namespace servoctl::can
