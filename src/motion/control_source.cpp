#include "motion/control_source.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "base/number.hpp"
#include "session/storage.hpp"

namespace servoctl::motion {

Result<OtherSource> other_source(session::Session& session, const MotionUnits& units,
                                 const OwedValues& owed) {
  for (const auto& need : units.profile().rules.nmt.needs) {
    const auto values = setting_of(session, units, need.name, owed);
    if (!values) return fail(values.error());
    const auto needed = static_cast<double>(need.value);
    const auto& held = values->front();
    const auto& in_force = values->back();
    const bool waits = values->size() > 1;
    if (in_force == needed) continue;
    if (waits && held == needed)
      return OtherSource{fmt::format("{} = {} waits for a restart", need.name, need.value),
                         "restart the drive"};
    if (!in_force) continue;
    return OtherSource{
        fmt::format("{} is {}, and {} is needed for CANopen", need.name, number_text(*in_force), need.value),
        fmt::format("`{}` and restart the drive",
                    lasting_setting(units.profile(), units.node(), need.name, need.value))};
  }
  return OtherSource{};
}

std::string lasting_setting(const drive::Profile& profile, std::uint8_t node, std::string_view name,
                            std::int64_t value) {
  auto out = fmt::format("param set {}={} -n {}", name, value, node);
  if (const auto& locked = profile.rules.store.locked; std::ranges::find(locked, name) != locked.end())
    out += " --unlock";
  if (session::can_store(profile)) out += " --keep";
  return out;
}

}  // namespace servoctl::motion
