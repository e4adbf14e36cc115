#pragma once

#include <functional>

#include "report/verdict.hpp"
#include "show/desk.hpp"

namespace servoctl::trial {

inline constexpr std::string_view kCommTestName = "comm";

/// What `test comm` looks at.
struct CommTrial {
  std::uint32_t count = 200;                          ///< Reads of 1000h.
  Duration longest = std::chrono::milliseconds(100);  ///< Longest round trip that passes.
  /// How late this computer has been so far: what it took is no time of the drive's. Null: run_delay(), on
  /// buses whose clock is that of this computer.
  std::function<Duration()> own_delay = {};
};

/// Reads an object many times over and listens to the heartbeat. What is judged is drive and bus: the time in
/// which servoctl waited for a processor is taken off, and an answer that was missed meanwhile is not counted
/// as lost. A drive that is simulated by another process of a busy computer may be late all the same.
/// Errc::bus or interrupted when it could not be done; a node that does not answer has failed it.
Result<report::TestResult> test_communication(show::Desk& desk, std::uint8_t node, const CommTrial& test);

}  // namespace servoctl::trial
