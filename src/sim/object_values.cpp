#include "sim/object_values.hpp"

#include <algorithm>

#include "canopen/sdo_abort.hpp"
#include "drive/quantity.hpp"
#include "drive/standard_objects.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;

void ObjectValues::load_defaults(std::uint8_t node) {
  values_.clear();
  for (const auto& object : profile_->dictionary.objects())
    for (const auto& entry : object.entries) load_default(entry, node);
  load_identity();
  if (has(objects::kSupportedModes) && number(objects::kSupportedModes) == 0)
    set_number(objects::kSupportedModes, supported_modes());
}

void ObjectValues::load_communication_defaults(std::uint8_t node) {
  for (const auto& object : profile_->dictionary.objects())
    if (in_communication_area(object.index))
      for (const auto& entry : object.entries) load_default(entry, node);
  load_identity();
}

void ObjectValues::load_default(const od::Entry& entry, std::uint8_t node) {
  auto& bytes = values_[entry.address];
  ++changes_;
  bytes.clear();
  if (entry.default_value)
    if (auto encoded = od::encode(entry.type, entry.default_value->for_node(node))) bytes = *encoded;
  if (bytes.empty()) bytes.resize(od::size_of(entry.type).value_or(0));
}

/// The identity its family tells, where the dictionary states none.
void ObjectValues::load_identity() {
  for (const auto& mark : profile_->rules.identity)
    if (has(mark.object) && mark.text.empty() && number(mark.object) == 0)
      set_number(mark.object, mark.value);
}

/// 6502h as the modes that 6060h takes: bit 0 for mode 1 (CiA 402-2, 6502h).
std::uint32_t ObjectValues::supported_modes() const {
  const auto* mode = profile_->dictionary.find(objects::kModeOfOperation);
  std::uint32_t out = 0;
  if (mode == nullptr) return out;
  for (const auto& label : mode->labels)
    if (label.value >= 1 && label.value <= 16) out |= 1U << static_cast<unsigned>(label.value - 1);
  return out;
}

void ObjectValues::start() {
  at_start_.clear();
  ++changes_;
  for (const auto& p : profile_->parameters)
    if (p.object && p.effect == od::Effect::restart) at_start_[*p.object] = get(*p.object);
  for (const auto& object : profile_->dictionary.objects())
    for (const auto& entry : object.entries)
      if (entry.effect == od::Effect::restart) at_start_[entry.address] = get(entry.address);
}

void ObjectValues::release() {
  if (held_.empty()) return;
  held_.clear();
  ++changes_;
}

const Bytes& ObjectValues::in_force(ObjectAddress object) const {
  if (const auto held = held_.find(object); held != held_.end()) return held->second;
  const auto found = at_start_.find(object);
  return found == at_start_.end() ? get(object) : found->second;
}

const Bytes& ObjectValues::get(ObjectAddress object) const {
  static const Bytes kNothing;
  const auto found = values_.find(object);
  return found == values_.end() ? kNothing : found->second;
}

void ObjectValues::set_number(ObjectAddress object, std::uint64_t value) {
  const auto* entry = profile_->dictionary.find(object);
  if (entry == nullptr) return;
  values_[object] = store_le(value, od::size_of(entry->type).value_or(4));
  ++changes_;
}

std::uint32_t ObjectValues::check_read(ObjectAddress object) const {
  const auto* entry = profile_->dictionary.find(object);
  if (entry == nullptr)
    return profile_->dictionary.object(object.index) == nullptr ? abort::kNoObject : abort::kNoSubIndex;
  return od::readable(entry->access) ? 0 : abort::kWriteOnly;
}

std::uint8_t ObjectValues::last_sub(std::uint16_t index) const {
  const auto* object = profile_->dictionary.object(index);
  std::uint8_t out = 0;
  if (object == nullptr) return out;
  for (const auto& entry : object->entries) out = std::max(out, entry.address.sub);
  return out;
}

std::uint32_t ObjectValues::check_writable(ObjectAddress object) const {
  const auto* entry = profile_->dictionary.find(object);
  if (entry == nullptr)
    return profile_->dictionary.object(object.index) == nullptr ? abort::kNoObject : abort::kNoSubIndex;
  return od::writable(entry->access) ? 0 : abort::kReadOnly;
}

std::uint32_t ObjectValues::check_write(ObjectAddress object, ByteSpan data, std::uint8_t node) const {
  if (const auto code = check_writable(object); code != 0) return code;
  const auto* entry = profile_->dictionary.find(object);
  const auto size = od::size_of(entry->type);
  if (size && data.size() != *size) {
    if (profile_->rules.sdo.exact_length) return abort::kLength;
    return data.size() > *size ? abort::kTooLong : abort::kTooShort;
  }
  const auto value = od::decode(entry->type, data);
  if (!value) return abort::kLength;
  const auto limits = drive::meaning(drive::target_at(profile_, object), node);
  if (limits.max && od::compare_numbers(*value, *limits.max) > 0) return abort::kTooHigh;
  if (limits.min && od::compare_numbers(*value, *limits.min) < 0) return abort::kTooLow;
  if (drive::is_too_little(limits, *value)) return abort::kRange;
  return 0;
}

}  // namespace servoctl::sim
