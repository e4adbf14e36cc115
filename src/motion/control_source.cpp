#include "motion/control_source.hpp"

#include <fmt/format.h>

#include "base/bytes.hpp"
#include "drive/naming.hpp"

namespace servoctl::motion {

OtherSource other_source(session::Session& session, const drive::Profile& profile, std::uint8_t node) {
  for (const auto& need : profile.rules.nmt.needs) {
    const auto place = drive::place_of(profile, need.name);
    const auto held = place ? session.upload(node, *place) : Result<Bytes>(Bytes());
    if (!held || held->empty()) continue;
    const auto value = static_cast<std::int64_t>(load_le(*held));
    if (value == need.value) continue;
    return {fmt::format("{} is {}, and {} is needed for CANopen", need.name, value, need.value),
            fmt::format("`param set {}={} -n {}` and restart the drive", need.name, need.value, node)};
  }
  return {};
}

}  // namespace servoctl::motion
