#include "drive/topic_scope.hpp"

#include <algorithm>

#include "base/number.hpp"
#include "drive/standard_mode.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::drive {
namespace {

/// Whether nothing shows that the family is on the other network only. CAN has communication parameters of
/// PDOs (1400h, 1800h), EtherCAT the assignment of PDOs to sync managers (1C12h).
bool may_be_on(const Profile& profile, std::string_view network) {
  if (profile.is_generic()) return true;
  const auto has = [&](std::uint16_t index) { return profile.dictionary.object(index) != nullptr; };
  const bool can = has(0x1400) || has(0x1800);
  const bool ethercat = profile.rules.coe.exists() || has(0x1C12);
  if (network == "can") return can || !ethercat;
  if (network == "ethercat") return ethercat || !can;
  return true;
}

/// Whether one of the modes that the family counts in 6060h is this mode of CiA 402-2.
bool has_mode(const Profile& profile, std::int64_t mode) {
  const auto* const entry = profile.dictionary.find(objects::kModeOfOperation);
  if (entry == nullptr || entry->labels.empty()) return true;
  return std::any_of(entry->labels.begin(), entry->labels.end(), [&](const od::EnumLabel& label) {
    return standard_mode(profile.rules.motion, static_cast<std::int8_t>(label.value)) == mode;
  });
}

/// Whether 6098h takes this method, and moves by it as the standard says of its number.
bool has_method(const Profile& profile, std::int64_t method) {
  const auto& like = profile.rules.motion.homing_like;
  if (const auto other = like.find(method); other != like.end() && other->second != method) return false;
  const auto* const entry = profile.dictionary.find(objects::kHomingMethod);
  if (entry == nullptr || entry->labels.empty()) return true;
  return std::any_of(entry->labels.begin(), entry->labels.end(),
                     [&](const od::EnumLabel& label) { return label.value == method; });
}

bool applies(const Topic& topic, const Profile& profile) {
  if (!may_be_on(profile, topic.network)) return false;
  if (topic.mode && !has_mode(profile, *topic.mode)) return false;
  if (!topic.object) return true;
  const auto* const object = profile.dictionary.object(topic.object->index);
  // A file of a drive that nobody knows may leave out what the drive has.
  if (object == nullptr) return profile.is_generic() || profile.dictionary.empty();
  if (topic.value && topic.object == objects::kModeOfOperation) return has_mode(profile, *topic.value);
  if (topic.value && topic.object == objects::kHomingMethod) return has_method(profile, *topic.value);
  const auto* const entry = profile.dictionary.find(*topic.object);
  const bool own_values = entry != nullptr && !entry->labels.empty() && !profile.is_generic();
  return topic.kind != "term" || !own_values;
}

void remove_other_methods(Topic& topic, const Profile& profile) {
  if (topic.object != objects::kHomingMethod || topic.value) return;
  std::erase_if(topic.rows, [&](const TopicRow& row) {
    const auto number = parse_signed(row.cells.front());
    return number && !has_method(profile, *number);
  });
}

}  // namespace

void remove_foreign_topics(std::vector<Topic>& topics, const Profile& profile) {
  if (profile.rules.family.empty()) return;
  std::erase_if(topics, [&](const Topic& topic) {
    return topic.family == kStandardFamily && !applies(topic, profile);
  });
  for (auto& topic : topics)
    if (topic.family == kStandardFamily) remove_other_methods(topic, profile);
}

}  // namespace servoctl::drive
