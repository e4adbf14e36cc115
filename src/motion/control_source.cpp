#include "motion/control_source.hpp"

#include "base/format.hpp"
#include "base/number.hpp"
#include "session/storage.hpp"

namespace servoctl::motion {

Result<std::optional<OtherSource>> other_source(session::Session& session, const MotionUnits& units,
                                                const OwedValues& owed) {
  for (const auto& need : units.profile().rules.nmt.needs) {
    const auto values = setting_of(session, units, need.name, owed);
    if (!values) return fail(values.error());
    const auto needed = static_cast<double>(need.value);
    const auto& held = values->front();
    const auto& in_force = values->back();
    if (in_force == needed) continue;
    const bool waits = values->size() > 1 && held == needed;
    if (!waits && !in_force) continue;
    return OtherSource{need.name, in_force.value_or(0), need.value, waits};
  }
  return std::optional<OtherSource>();
}

std::string OtherSource::cause() const {
  return waits ? formatted("{} = {} waits for a restart", name, needed)
               : formatted("{} is {}, and {} is needed for CANopen", name, number_text(in_force), needed);
}

std::string OtherSource::remedy(const drive::Profile& profile, std::uint8_t node) const {
  return waits ? std::string("restart the drive")
               : formatted("`{}` and restart the drive", lasting_setting(profile, node, name, needed));
}

std::string lasting_setting(const drive::Profile& profile, std::uint8_t node, std::string_view name,
                            std::int64_t value) {
  auto out = formatted("param set {}={} -n {}", name, value, node);
  if (profile.rules.store.locks(name)) out += " --unlock";
  if (session::can_store(profile)) out += " --keep";
  return out;
}

}  // namespace servoctl::motion
