// Which switches a simulated drive acts on: its parameters may tell it to ignore some.
#include <algorithm>

#include "drive/naming.hpp"
#include "drive/quantity.hpp"
#include "sim/axis.hpp"

namespace servoctl::sim {

std::vector<Axis::SwitchRule> Axis::find_switch_rules() const {
  std::vector<SwitchRule> out;
  for (const auto& rule : profile_->rules.cautions)
    if (!rule.masks.empty()) {
      out.push_back({&rule, {{rule.name, drive::place_of(*profile_, rule.name)}}});
      for (const auto& name : rule.others)
        out.back().parameters.emplace_back(name, drive::place_of(*profile_, name));
    }
  return out;
}

bool Axis::holds(const SwitchRule& rule) const {
  return !rule.rule->is_conditional() || std::ranges::all_of(rule.parameters, [&](const auto& parameter) {
    return holds(*rule.rule, parameter.first, parameter.second);
  });
}

/// A parameter without an object holds what its panel was told, else what the factory put there.
bool Axis::holds(const drive::Caution& rule, const std::string& name,
                 std::optional<ObjectAddress> object) const {
  if (object) {
    const auto& meaning = meaning_of(*object);
    const auto value = od::decode(meaning.type, values_->in_force(*object));
    return value && rule.holds(od::decode_number(meaning.encoding, *value));
  }
  if (const auto told = panel_.find(name); told != panel_.end())
    return rule.holds(static_cast<double>(told->second));
  const auto* parameter = profile_->parameter(name);
  return parameter != nullptr && parameter->default_value &&
         rule.holds(od::to_double(*parameter->default_value));
}

void Axis::look_at_switch_rules() {
  track_.masked = {};
  track_.maskable = {};
  for (const auto& rule : switch_rules_) {
    const bool now = holds(rule);
    for (const auto input : rule.rule->masks) {
      const auto which = static_cast<std::size_t>(input);
      track_.maskable[which] = true;
      track_.masked[which] = track_.masked[which] || now;
    }
  }
}

}  // namespace servoctl::sim
