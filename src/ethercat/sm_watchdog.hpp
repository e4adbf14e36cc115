#pragma once

#include <cstdint>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"
#include "ethercat/request.hpp"

namespace servoctl::ethercat {

/// How long a slave goes on without outputs before it leaves OP with AL status code 001Bh (ETG.1000.4, 6.3).
/// What its drive does then is the drive's own rule.
struct SmWatchdog {
  std::uint16_t divider = 0;  ///< 0400h: a step takes (divider + 2) * 40 ns.
  std::uint16_t steps = 0;    ///< 0420h; 0: it is off.

  bool is_on() const { return steps != 0; }
  Duration time() const;  ///< Rounded down to a microsecond.
  /// The writes that set it. To be made before SAFE-OP.
  std::vector<Request> requests(SlaveAddress slave) const;
};

/// The watchdog that bites after `time`, rounded up to 100 us. Errc::usage for none at all and for more
/// than 6.5 s.
Result<SmWatchdog> sm_watchdog(Duration time);

}  // namespace servoctl::ethercat
