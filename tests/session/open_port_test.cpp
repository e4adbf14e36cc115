// From the URL of a wire with EtherCAT to its port.
#include "session/open_port.hpp"

#include <gtest/gtest.h>

#include "tests/source_dir.hpp"

namespace servoctl::session {
namespace {

const std::filesystem::path kFolders[] = {std::filesystem::path(source_dir()) / "eds"};

Result<std::unique_ptr<ethernet::Port>> open(std::string_view url) {
  return open_port(
      url, BusOptions{.drive_folders = kFolders, .trace = {}, .clock = sim::SimBus::Clock::virtual_time});
}

TEST(OpenPort, SimulatedDrivesAreInThisProcess) {
  const auto port = open("coe:sim:sv2@1,sv2@2");
  ASSERT_TRUE(port) << port.error().message;
  EXPECT_TRUE((*port)->has_link());
}

TEST(OpenPort, WhatIsNoEtherCatBusIsTold) {
  const auto port = open("coe:smi:sv2@1");
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, Errc::usage);
  EXPECT_EQ(port.error().message, "'coe:smi:sv2@1' is not an EtherCAT bus");
  EXPECT_EQ(port.error().hint, "did you mean sim?");
}

TEST(OpenPort, OnlyUrlsOfEtherCatAreItsOwn) {
  EXPECT_TRUE(is_ethercat("coe:eth0"));
  EXPECT_FALSE(is_ethercat("can0"));
  EXPECT_FALSE(is_ethercat("sim:sv2@1"));
}

}  // namespace
}  // namespace servoctl::session
