#include "drive/standard_mode.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "drive/cia402.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::drive {

std::int8_t standard_mode(const MotionRules& rules, std::int8_t mode) {
  const std::array<std::pair<std::optional<std::int8_t>, std::int8_t>, 4> named{
      {{rules.position, std::int8_t{1}},
       {rules.velocity, std::int8_t{3}},
       {rules.torque, std::int8_t{4}},
       {rules.homing, std::int8_t{6}}}};
  const bool as_the_standard = std::all_of(
      named.begin(), named.end(), [](const auto& one) { return !one.first || one.first == one.second; });
  if (as_the_standard) return mode;
  // Without the handshake its position mode is none that the standard has.
  if (mode == rules.position && !rules.handshake) return 0;
  for (const auto& [own, standard] : named)
    if (own == mode) return standard;
  return 0;
}

std::string mode_word(const Profile* profile, std::int8_t mode, bool chinese) {
  if (profile == nullptr || standard_mode(profile->rules.motion, mode) == mode)
    return std::string(mode_abbreviation(mode));
  const auto meaning = drive::meaning(target_at(profile, objects::kModeDisplay), 0);
  const auto* label = label_of(meaning, od::Value(std::int64_t{mode}));
  if (label == nullptr) return {};
  return chinese && !label->label_zh.empty() ? label->label_zh : label->label;
}

}  // namespace servoctl::drive
