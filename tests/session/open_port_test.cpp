// From the URL of a wire with EtherCAT to its port.
#include "session/open_port.hpp"

#include <gtest/gtest.h>

#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

const std::vector<std::filesystem::path> kFolders = {std::filesystem::path(source_dir()) / "eds"};

Result<std::unique_ptr<ethernet::Port>> open(std::string_view url) {
  return open_port(
      url, BusOptions{.drive_folders = kFolders, .trace = {}, .clock = sim::SimBus::Clock::virtual_time});
}

TEST(OpenPort, SimulatedDrivesAreInThisProcess) {
  const auto port = open("coe:sim:sv2@1,sv2@2");
  ASSERT_TRUE(port) << port.error().message.text();
  EXPECT_TRUE((*port)->has_link());
}

TEST(OpenPort, WhatIsNoEtherCatBusIsTold) {
  const auto port = open("coe:smi:sv2@1");
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, Errc::usage);
  EXPECT_EQ(port.error().message.text(), "'coe:smi:sv2@1' is not an EtherCAT bus");
  EXPECT_EQ(port.error().hint.text(), "did you mean sim?");
}

TEST(OpenPort, WhatStandsBehindItsNameSaysWhichWireItIs) {
  EXPECT_EQ(open("coe:nosucheth7").error().message.text(), "there is no interface nosucheth7");
  EXPECT_EQ(open("coe:local:a/b").error().message.text(), "'a/b' cannot be the name of a local bus");
  for (const auto* url : {"coe:", "coe::", "coe:x:", "can0", ""}) {
    const auto port = open(url);
    ASSERT_FALSE(port) << url;
    EXPECT_EQ(port.error().code, Errc::usage) << url;
    EXPECT_EQ(port.error().hint.text(), "write coe:eth0, coe:local:NAME or coe:sim:FAMILY@1") << url;
  }
}

TEST(OpenPort, WhatIsSimulatedHasNoOtherEnd) {
  const auto port = open_ring_port("coe:sim:sv2@1", BusOptions());
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, Errc::usage);
  EXPECT_EQ(port.error().message.text(), "a simulated drive cannot be put on a bus that is simulated itself");
  EXPECT_EQ(open_ring_port("coe:nosucheth7", BusOptions()).error().message.text(),
            "there is no interface nosucheth7");
}

TEST(OpenPort, ATraceIsAPcapOnEtherCatAndNoneOnCan) {
  const auto folder = std::filesystem::path(testing::TempDir());
  BusOptions options;
  options.drive_folders = kFolders;
  options.trace = folder / "open_port.log";
  options.clock = sim::SimBus::Clock::virtual_time;
  const auto port = open_port("coe:sim:sv2@1", options);
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, Errc::usage);
  EXPECT_EQ(port.error().message.text().find("the trace of an EtherCAT bus is a .pcap or .pcapng, not "), 0U);
  EXPECT_EQ(port.error().hint.text(), "name it open_port.pcap; Wireshark opens it");
  options.trace = folder / "open_port.pcap";
  EXPECT_TRUE(open_port("coe:sim:sv2@1", options));
  EXPECT_TRUE(std::filesystem::exists(options.trace));
  std::filesystem::remove(options.trace);
  const auto bus = open_bus("sim:sv2@1", options);
  ASSERT_FALSE(bus);
  EXPECT_EQ(bus.error().code, Errc::usage);
  EXPECT_EQ(bus.error().hint.text(), "name it open_port.log; .pcap is for the frames of a coe: bus");
  EXPECT_FALSE(std::filesystem::exists(options.trace));
}

TEST(OpenPort, OnlyUrlsOfEtherCatAreItsOwn) {
  EXPECT_TRUE(is_ethercat("coe:eth0"));
  EXPECT_FALSE(is_ethercat("can0"));
  EXPECT_FALSE(is_ethercat("sim:sv2@1"));
}

}  // namespace
}  // namespace servoctl::session
