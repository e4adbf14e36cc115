#include "drive/access_alarms.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include "base/file.hpp"
#include "drive/shared_profile.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::drive {
namespace {

/// Whether a numbering gives the object a parameter number although the parameter table may not list it.
bool has_unlisted_number(const Rules& rules, ObjectAddress object) {
  constexpr unsigned kRange = 0xF000;
  return std::any_of(rules.numbering.begin(), rules.numbering.end(), [&](const Numbering& rule) {
    return rule.unlisted && object.sub == rule.first_sub && (object.index & kRange) == (rule.index & kRange);
  });
}

}  // namespace

bool stops_a_drive(ObjectAddress object) {
  constexpr ObjectAddress kStopping[] = {objects::kControlword, objects::kStatusword,
                                         objects::kModeOfOperation, objects::kModeDisplay,
                                         objects::kTargetVelocity};
  return std::ranges::find(kStopping, object) != std::end(kStopping);
}

bool has_access_alarms(const Rules& rules) {
  return !rules.fault.object_alarm.empty() || !rules.fault.sub_index_alarm.empty();
}

std::shared_ptr<const Rules> alarm_rules(const Family& family) {
  // A key in quotes may be written with the last two.
  constexpr std::string_view kSigns[] = {"object_alarm", "sub_index_alarm", "\\u", "\\U"};
  const auto text = read_file(rules_file(family));
  const auto stands_there = [&](std::string_view sign) { return text->find(sign) != std::string::npos; };
  if (!text || !std::any_of(std::begin(kSigns), std::end(kSigns), stands_there)) return nullptr;
  const auto rules = shared_rules(family);
  return rules && has_access_alarms(**rules) ? *rules : nullptr;
}

std::string_view possible_alarm(const Profile& profile, ObjectAddress object) {
  const auto& rules = profile.rules;
  if (!has_access_alarms(rules) || stops_a_drive(object) || profile.dictionary.find(object) != nullptr)
    return {};
  const bool has_index = profile.dictionary.object(object.index) != nullptr;
  return has_index ? rules.fault.sub_index_alarm : rules.fault.object_alarm;
}

std::string_view access_alarm(const Profile& profile, ObjectAddress object) {
  return has_unlisted_number(profile.rules, object) ? std::string_view() : possible_alarm(profile, object);
}

}  // namespace servoctl::drive
