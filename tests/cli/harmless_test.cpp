// --read-only and --dry-run: every command on every family, and every frame that it sends.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "can/frame.hpp"
#include "command/command.hpp"
#include "command/registry.hpp"
#include "sample_lines.hpp"

namespace servoctl::cli {
namespace {

constexpr std::uint8_t kDrives = 3;  ///< Nodes 1 and 2, and 3 for `sim`.

/// Whether it is a request of LSS that asks, or says who is asked (CiA 305).
bool looks_by_lss(const can::Frame& frame) {
  const auto service = frame.data[0];
  return frame.id == 0x7E5 && (service == 0x04 || (service >= 0x40 && service <= 0x5E));
}

/// Whether it comes from a simulated drive, or is an SDO request that only reads.
bool is_harmless(const can::Frame& frame) {
  if (frame.extended || frame.error) return false;
  if (looks_by_lss(frame)) return true;
  if (frame.id > 0x600 && frame.id <= 0x67F && !frame.remote) {
    const auto command = frame.data[0] >> 5U;  // CiA 301, 7.2.4.3: client command specifier.
    return command == 2 || command == 3 || command == 4 || command == 5;
  }
  const auto node = frame.id & 0x7FU;
  const auto service = frame.id - node;
  const bool of_a_drive = service == 0x080 || service == 0x180 || service == 0x280 || service == 0x380 ||
                          service == 0x480 || service == 0x580 || service == 0x700;
  return of_a_drive && node >= 1 && node <= kDrives && !frame.remote;
}

class Harmless : public testing::TestWithParam<std::string> {
 protected:
  void expect_harmless(const std::string& option, bool each_is_understood) {
    std::size_t in_all = 0;
    for (const auto* command : command::registry()) {
      const auto sample = kSampleLines.find(std::string(command->path));
      ASSERT_NE(sample, kSampleLines.end()) << "give '" << command->path << "' a sample line";
      const auto code = lines.perform(sample->second, option);
      // Not every family has every object; one has all. Nothing runs that `sync stop` could end, no drive is
      // put on a simulated bus, and this one is not EtherCAT.
      const bool elsewhere = includes(command->needs, command::Needs::ethercat);
      if (each_is_understood && !elsewhere && sample->first != "sync stop" && sample->first != "sim") {
        EXPECT_NE(code, exit_code(Errc::usage)) << sample->second << "\n" << lines.console.err_text;
      }
      for (const auto& frame : lines.frames)
        EXPECT_TRUE(is_harmless(frame)) << sample->second << " " << option << ": " << can::to_string(frame);
      in_all += lines.frames.size();
    }
    EXPECT_GT(in_all, 500U) << "most of them read something";
  }

  SampleLines lines{GetParam()};
};

TEST_P(Harmless, ReadOnlySendsNothingButReadingRequests) {
  expect_harmless("--read-only", GetParam() == "gsd600");
}

TEST_P(Harmless, ADryRunSendsNothingButReadingRequests) {
  expect_harmless("--dry-run", GetParam() == "gsd600");
}

INSTANTIATE_TEST_SUITE_P(Families, Harmless, testing::Values("gsd600", "dm", "da200", "ts", "sv2", "cia402"),
                         [](const auto& family) { return family.param; });

}  // namespace
}  // namespace servoctl::cli
