#include "motion/speed_monitor.hpp"

#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {
namespace {

constexpr double kRestRpm = 3;  ///< That a monitor may show at rest.

}  // namespace

SpeedMonitor::SpeedMonitor(Motion& motion, const Learn& learn) : motion_(&motion), learn_(&learn) {
  const auto size = od::size_of(motion.units().meaning(learn.monitor).type).value_or(4);
  step_ = std::abs(rpm_of(store_le(1, size)));
}

double SpeedMonitor::rpm_of(const Bytes& data) const {
  const auto value = motion_->units().physical(learn_->monitor, data);
  return value ? value->value : 0;
}

Result<double> SpeedMonitor::read() {
  const session::Hurry hurry(motion_->session(), kMovingPatience, 1);
  const auto answer = motion_->session().upload(motion_->node(), learn_->monitor);
  if (!answer) return fail(answer.error());
  return rpm_of(*answer);
}

Result<void> SpeedMonitor::check_still() {
  const auto shown = motion_->session().upload(motion_->node(), learn_->monitor);
  if (!shown) {
    if (shown.error().code != Errc::sdo_abort) return fail(shown.error());
    return fail(motion_->error(Errc::refused,
                               message("does not show the motor speed: {} ({}) cannot be read",
                                       learn_->monitor_name, to_string(learn_->monitor)),
                               std::string(kOtherWay)));
  }
  const auto rpm = motion_->units().physical(learn_->monitor, *shown);
  if (!rpm || std::abs(rpm->value) <= kRestRpm) return {};
  return fail(motion_->error(
      Errc::refused,
      message("is not energised, but {} shows {} rpm", learn_->monitor_name, number_text(rpm->value)),
      "wait until the motor stands still; a wrong monitor cannot be used to measure"));
}

}  // namespace servoctl::motion
