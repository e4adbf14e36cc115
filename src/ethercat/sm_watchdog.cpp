#include "ethercat/sm_watchdog.hpp"

#include "base/format.hpp"
#include "ethercat/registers.hpp"

namespace servoctl::ethercat {
namespace {

constexpr std::int64_t kStep = 100;  ///< Microseconds, of the default divider.
constexpr std::int64_t kMostSteps = 0xFFFF;

}  // namespace

Duration SmWatchdog::time() const {
  return Duration((std::int64_t{divider} + 2) * 40 * std::int64_t{steps} / 1000);
}

std::vector<Request> SmWatchdog::requests(SlaveAddress slave) const {
  return {write_registers(slave, reg::kWatchdogDivider, store_le(divider, 2)),
          write_registers(slave, reg::kSmWatchdog, store_le(steps, 2))};
}

Result<SmWatchdog> sm_watchdog(Duration time) {
  const auto steps = (time.count() + kStep - 1) / kStep;
  if (steps < 1 || steps > kMostSteps)
    return fail(
        Errc::usage,
        message("a watchdog of {} ms cannot be set", std::chrono::duration<double, std::milli>(time).count()),
        "allowed: 0.1 ms to 6553.5 ms");
  return SmWatchdog{reg::kDefaultWatchdogDivider, static_cast<std::uint16_t>(steps)};
}

}  // namespace servoctl::ethercat
