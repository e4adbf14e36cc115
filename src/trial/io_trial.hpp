#pragma once

#include <string_view>
#include <vector>

#include "report/verdict.hpp"
#include "show/desk.hpp"

namespace servoctl::trial {

/// What `test io` waits for.
struct InputTrial {
  std::vector<unsigned> expected;  ///< Bits of 60FDh; empty: whatever changes.
  Duration length = std::chrono::seconds(30);
};

/// `positive-limit,home,bit16`: bits of 60FDh by their function in this family, or by number. Errc::usage.
Result<std::vector<unsigned>> parse_inputs(const show::Desk& desk, std::string_view text);

/// Watches the inputs of one drive while somebody actuates them, until each was seen both ways, or the time
/// is over, or Ctrl-C. Errc::sdo_abort where the drive has no 60FDh.
Result<report::TestResult> test_inputs(show::Desk& desk, std::uint8_t node, const InputTrial& test);

}  // namespace servoctl::trial
