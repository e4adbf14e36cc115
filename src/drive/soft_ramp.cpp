#include "drive/soft_ramp.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace servoctl::drive {
namespace {

struct RampUnit {
  std::string_view ramp;
  std::string_view speed;
};
constexpr std::array kRampUnits{RampUnit{"rpm/s", "rpm"}, RampUnit{"inc/s2", "inc/s"},
                                RampUnit{"rad/s2", "rad/s"}};

constexpr double kSpeedOfTimes = 3000;
constexpr double kShortestMs = 200;
constexpr double kLongestMs = 30000;

}  // namespace

std::optional<double> soft_ramp(std::string_view ramp_unit, std::string_view speed_unit, double speed,
                                double seconds) {
  if (speed == 0 || seconds <= 0) return std::nullopt;
  for (const auto& row : kRampUnits)
    if (row.ramp == ramp_unit && row.speed == speed_unit) return std::abs(speed) / seconds;
  if (ramp_unit != "ms" || speed_unit != "rpm") return std::nullopt;
  return std::clamp(seconds * 1000 * kSpeedOfTimes / std::abs(speed), kShortestMs, kLongestMs);
}

}  // namespace servoctl::drive
