#pragma once

#include "report/verdict.hpp"
#include "show/desk.hpp"

namespace servoctl::trial {

inline constexpr std::string_view kCommTestName = "comm";

/// What `test comm` looks at.
struct CommTrial {
  std::uint32_t count = 200;                          ///< Reads of 1000h.
  Duration longest = std::chrono::milliseconds(100);  ///< Longest round trip that passes.
};

/// Reads an object many times over and listens to the heartbeat. Errc::bus or interrupted when it could not
/// be done; a node that does not answer has failed it.
Result<report::TestResult> test_communication(show::Desk& desk, std::uint8_t node, const CommTrial& test);

}  // namespace servoctl::trial
