// How a motion is watched until it is over, or has to end.
#include <algorithm>
#include <new>

#include "base/format.hpp"
#include "motion/motion.hpp"
#include "session/option_scope.hpp"

namespace servoctl::motion {

/// What a motion keeps grows with its time.
Result<bool> Motion::watch(const std::function<Result<bool>(const MotionSample&)>& done, Duration longest) {
  try {
    return supervise(done, longest);
  } catch (const std::bad_alloc&) {
    return fail(
        error(Errc::bug, "out of memory: the motion ends", "use a shorter motion, or free some memory"));
  }
}

/// It ends by time, and not behind an answer that comes late or never: what is asked of the drive then, the
/// time cuts short.
Result<bool> Motion::supervise(const std::function<Result<bool>(const MotionSample&)>& done,
                               Duration longest) {
  const auto end = session_->now() + longest;
  // Without a length it is one look.
  const bool one_look = longest <= Duration::zero();
  const auto limit = one_look ? kNever : std::min(end, session_->options().until);
  const session::OptionScope until(*session_, &session::Options::until, limit);
  const auto is_over = [&](const Error& error) {
    const auto& cancelled = session_->options().cancelled;
    return error.code == Errc::interrupted && session_->now() >= end && !(cancelled && cancelled());
  };
  for (;;) {
    const auto sample = monitor_->sample(one_look ? kNever : end);
    if (!sample && is_over(sample.error())) return false;
    if (!monitor_->samples().empty() && options_.on_sample) options_.on_sample(monitor_->samples().back());
    if (!sample) return fail(sample.error());
    if (const auto fits = check_turn(*sample); !fits) {
      if (is_over(fits.error())) return false;
      return fail(fits.error());
    }
    if (const auto foreign = guard_ ? guard_->foreign_command() : std::nullopt)
      return fail(error(
          Errc::negative,
          foreign->by_pdo()
              ? message("another master sent a PDO with object {} while moving", to_string(foreign->object))
              : message("another master wrote object {} while moving", to_string(foreign->object)),
          std::string(MotionGuard::kTwoMasters)));
    if (options_.unheard && options_.unheard())
      return fail(error(Errc::interrupted, "the output is no longer read: the motion ends"));
    const auto enough = done(*sample);
    if (!enough || *enough) return enough;
    if (session_->now() >= end) return false;
    const auto waited = monitor_->wait_for_next();
    if (!waited && is_over(waited.error())) return false;
    if (!waited) return fail(waited.error());
  }
}

Result<void> Motion::wait_for_rest(Duration longest) {
  const auto rested =
      watch([this](const MotionSample& sample) -> Result<bool> { return stands_still(sample); }, longest);
  if (!rested) return fail(rested.error());
  if (*rested) return {};
  return fail(error(Errc::negative, "did not come to rest in time at the end of the motion",
                    "check its deceleration (6084h) and its load"));
}

}  // namespace servoctl::motion
