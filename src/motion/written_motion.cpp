#include "motion/written_motion.hpp"

#include "base/format.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::motion {
namespace {

using Least = WrittenQuantity::Least;

Result<void> check_one(const MotionUnits& units, const WrittenQuantity& written) {
  if (written.text.empty()) return {};
  const bool also_a_ceiling =
      written.object == objects::kTorqueActual && units.profile().rules.motion.torque.has_value();
  if (written.is_limit && !also_a_ceiling && !units.has(written.object))
    return fail(Errc::usage,
                message("{} {}: this family does not report it ({})", written.word, as_it_is(written.text),
                        to_string(written.object)),
                "leave this limit out");
  if (!units.has(written.object)) return {};
  const auto value = units.check(written.object, written.text, written.kind, written.is_limit);
  if (!value) {
    auto error = value.error();
    error.message = message("{}: {}", written.word, error.message);
    return fail(std::move(error));
  }
  if (written.least == Least::above_zero && *value <= 0)
    return fail(Errc::usage,
                message("{}: '{}' must be above 0, without a sign", written.word, as_it_is(written.text)));
  if (written.least == Least::not_zero && *value == 0)
    return fail(Errc::usage, message("{}: '{}' moves nothing", written.word, as_it_is(written.text)));
  return {};
}

}  // namespace

Result<void> check_written(const drive::Profile& profile, std::uint8_t node, const MotionOptions& options,
                           std::span<const WrittenQuantity> quantities) {
  const MotionUnits units(profile, node, options.turn, options.encoder, options.load);
  for (const auto& written : quantities)
    if (const auto right = check_one(units, written); !right) return right;
  const auto limit = [](std::string_view word, ObjectAddress object, std::string_view text) {
    return WrittenQuantity{.word = word, .object = object, .text = text, .is_limit = true};
  };
  const WrittenQuantity common[] = {
      limit("--limit", objects::kTargetVelocity, options.speed_limit),
      limit("--max-torque", objects::kTorqueActual, options.max_torque),
      limit("--max-following-error", objects::kFollowingError, options.max_following_error),
      limit("--window", objects::kPositionActual, options.window),
      {.word = "--accel", .object = objects::kProfileAcceleration, .text = options.acceleration}};
  for (const auto& written : common)
    if (const auto right = check_one(units, written); !right) return right;
  return {};
}

}  // namespace servoctl::motion
