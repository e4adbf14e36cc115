// What the family's data and missing knowledge forbid a motion.
#include <algorithm>

#include "base/format.hpp"
#include "base/number.hpp"
#include "drive/standard_objects.hpp"
#include "motion/motion_kinds.hpp"
#include "session/measure.hpp"
#include "show/owed_restart.hpp"

namespace servoctl::motion {

/// Where the drive goes by other numbers of its units than those that it holds, a motion would be another one
/// than was asked for.
Result<void> Motion::check_units_in_force() const {
  const auto waiting = owed().values;
  for (const auto& value : waiting)
    for (const auto& [measure, ways] : profile_->rules.units)
      for (const auto& way : ways) {
        const auto objects = way.objects();
        if (std::ranges::find(objects, value.object) == objects.end()) continue;
        return fail(
            drive_error(Errc::refused, node_, value.object,
                        message("what a turn of the motor is, is not known: {}: {}", show::owed_lead(waiting),
                                show::owed_text(profile_, node_, waiting, false)),
                        message("restart the drive first; `status --restarted -n {}` says that it was",
                                node_name(node_))));
      }
  return {};
}

Result<void> Motion::intend(const Purpose& purpose) {
  purpose_ = purpose;
  const auto held = held_cautions(*session_, *units_, options_.panel, owed().values,
                                  [](const drive::Caution& rule) { return rule.is_rule(); });
  if (!held) return fail(held.error());
  return check_cautions(*held, *units_, purpose);
}

Result<std::vector<PreflightItem>> Motion::look_at_drive(bool chinese) {
  auto source = motion::other_source(*session_, *units_, owed().values);
  if (!source) return fail(source.error());
  source_ = std::move(*source);
  return preflight(*session_, *units_, node_, chinese, request());
}

/// The least of what cautions say that hold, or may hold.
Result<std::optional<double>> Motion::cap_of_cautions(ObjectAddress as,
                                                      std::string drive::Caution::*text) const {
  const auto held = held_cautions(*session_, *units_, options_.panel, owed().values,
                                  [text](const drive::Caution& rule) { return !(rule.*text).empty(); });
  if (!held) return fail(held.error());
  std::optional<double> out;
  for (const auto& each : *held) {
    const auto cap = units_->parse_physical(as, each.rule->*text, MotionUnits::Kind::size);
    if (!cap) return fail(cap.error());
    out = std::min(cap->value, out.value_or(cap->value));
  }
  return out;
}

/// Increments in a turn by which a speed in increments is judged while nothing proves them: those that were
/// told earlier for this drive, else the fewest of the family, by which every speed is at its greatest.
std::optional<double> Motion::supposed_turn() {
  const auto what = units_->meaning(objects::kTargetVelocity);
  if (what.measure != drive::Measure::increments_per_turn) return std::nullopt;
  if (options_.supposed_turn) return options_.supposed_turn;
  const double least = profile_->rules.learn.least;
  if (least <= 0) return std::nullopt;
  const session::MeasureQuestion question[] = {{node_, drive::Measure::increments_per_turn, least}};
  const auto answer = session::read_measures(*session_, *profile_, question).front();
  return answer && answer->value > 1 ? std::optional(answer->value) : std::nullopt;
}

Result<double> Motion::find_unconverted_cap(std::optional<double> most) {
  const auto unit = units_->unit(objects::kTargetVelocity);
  if (supposed_turn_) {
    const double safe = kSafeRpm / 60 * *supposed_turn_;
    return std::min(safe, most.value_or(safe));
  }
  return fail(Errc::usage, "no safe speed is known for this drive: its speeds cannot be converted to rpm",
              message("add --limit in {}", unit.empty() ? "the drive's own unit" : unit));
}

/// What limits the speed while the counts of a turn are not known.
std::string Motion::unconverted_limit() const {
  const auto counts = plain_number(*supposed_turn_, 12);
  const auto unit = units_->unit(objects::kTargetVelocity);
  return options_.supposed_turn
             ? formatted(
                   "the counts per turn are not known (--turn): the limit is {} {}, which is {} rpm at {}, given for "
                   "this drive earlier",
                   number_text(*speed_cap_), unit, number_text(kSafeRpm), counts)
             : formatted(
                   "the counts per turn are not known (--turn): the limit is {} {}, which is {} rpm at {}, the "
                   "fewest of this family",
                   number_text(*speed_cap_), unit, number_text(kSafeRpm), counts);
}

Error unproven_speed(const Motion& motion) {
  const auto unit = motion.units().unit(objects::kTargetVelocity);
  return motion.error(Errc::refused, "no speed given, and the drive's own speed cannot be converted to rpm",
                      message("add --speed and --limit in {}", unit.empty() ? "the drive's own unit" : unit));
}

}  // namespace servoctl::motion
