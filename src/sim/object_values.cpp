#include "sim/object_values.hpp"

#include "canopen/sdo_abort.hpp"
#include "drive/quantity.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;

void ObjectValues::load_defaults(std::uint8_t node) {
  values_.clear();
  for (const auto& object : profile_->dictionary.objects()) {
    for (const auto& entry : object.entries) {
      auto& bytes = values_[entry.address];
      if (entry.default_value)
        if (auto encoded = od::encode(entry.type, entry.default_value->for_node(node))) bytes = *encoded;
      if (bytes.empty()) bytes.resize(od::size_of(entry.type).value_or(0));
    }
  }
  // The identity its family tells, where the dictionary states none.
  for (const auto& mark : profile_->rules.identity)
    if (has(mark.object) && mark.text.empty() && number(mark.object) == 0) set_number(mark.object, mark.value);
}

const Bytes& ObjectValues::get(ObjectAddress object) const {
  static const Bytes kNothing;
  const auto found = values_.find(object);
  return found == values_.end() ? kNothing : found->second;
}

void ObjectValues::set_number(ObjectAddress object, std::uint64_t value) {
  const auto* entry = profile_->dictionary.find(object);
  if (entry != nullptr) values_[object] = store_le(value, od::size_of(entry->type).value_or(4));
}

std::uint32_t ObjectValues::check_read(ObjectAddress object) const {
  const auto* entry = profile_->dictionary.find(object);
  if (entry == nullptr)
    return profile_->dictionary.object(object.index) == nullptr ? abort::kNoObject : abort::kNoSubIndex;
  return od::readable(entry->access) ? 0 : abort::kWriteOnly;
}

std::uint32_t ObjectValues::check_write(ObjectAddress object, ByteSpan data, std::uint8_t node) const {
  const auto* entry = profile_->dictionary.find(object);
  if (entry == nullptr)
    return profile_->dictionary.object(object.index) == nullptr ? abort::kNoObject : abort::kNoSubIndex;
  if (!od::writable(entry->access)) return abort::kReadOnly;
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
  return 0;
}

}  // namespace servoctl::sim
