#include <gtest/gtest.h>

#include "cli/bus_holder.hpp"

namespace servoctl::cli {
namespace {

using Names = std::vector<std::string>;

TEST(BusHint, NamesCanInterfacesAndEthernetPortsWithALink) {
  EXPECT_EQ(bus_hint(Names{"can0", "can1"}, Names{}).text(), "add --bus can0 or can1 or set SERVOCTL_BUS");
  EXPECT_EQ(bus_hint(Names{"can0"}, Names{"coe:eth0"}).text(),
            "add --bus can0 or set SERVOCTL_BUS; for EtherCAT drives on the Ethernet port with a link: --bus "
            "coe:eth0");
  EXPECT_EQ(bus_hint(Names{}, Names{"coe:eth0", "coe:eth1"}).text(),
            "this machine has no CAN interface; for EtherCAT drives on an Ethernet port with a link: --bus "
            "coe:eth0 or coe:eth1; else try `--bus sim:FAMILY@1` (`drives` lists families), or local:NAME");
  EXPECT_EQ(bus_hint(Names{}, Names{}).text(),
            "this machine has no CAN interface; try `--bus sim:FAMILY@1` (`drives` lists families), or "
            "local:NAME");
}

}  // namespace
}  // namespace servoctl::cli
