#include "sim/mapping_guard.hpp"

#include <algorithm>

#include "base/pdo_index.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;

std::uint32_t MappingGuard::check(ObjectAddress object, ByteSpan data) const {
  if (!is_pdo_mapping(object.index)) return 0;
  const auto value = load_le(data);
  if (object.sub == 0) return check_count(object.index, value);
  if (values_->number({object.index, 0}) != 0) return profile_->rules.pdo.mapped_abort;
  return value == 0 ? 0 : check_entry(object.index, static_cast<std::uint32_t>(value));
}

std::uint32_t MappingGuard::check_count(std::uint16_t index, std::uint64_t count) const {
  const auto& rules = profile_->rules.pdo;
  if (count > std::min(rules.most_entries, values_->last_sub(index))) return abort::kPdoLength;
  std::uint32_t bits = 0;
  for (std::uint64_t sub = 1; sub <= count; ++sub) {
    const auto entry = static_cast<std::uint32_t>(values_->number({index, static_cast<std::uint8_t>(sub)}));
    if (entry == 0) return abort::kPdoLength;  // Nothing is mapped there.
    if (const auto code = check_entry(index, entry); code != 0) return code;
    bits += entry & 0xFFU;
  }
  return bits > rules.most_bits ? abort::kPdoLength : 0;
}

std::uint32_t MappingGuard::check_entry(std::uint16_t index, std::uint32_t mapping) const {
  const ObjectAddress object{static_cast<std::uint16_t>(mapping >> 16U),
                             static_cast<std::uint8_t>(mapping >> 8U & 0xFFU)};
  const auto bits = mapping & 0xFFU;
  const bool transmit = pdo_at(index)->direction == PdoDirection::transmit;
  // Gaps on EtherCAT, in either direction (ETG.1000.6, 5.6.7.4.6).
  if (object == ObjectAddress{0, 0} && profile_->rules.coe.exists()) return 0;
  if (object.index == 0) return abort::kNoObject;
  if (object.index < 0x20) return transmit ? abort::kNotMappable : 0;  // Dummy entries fill RPDOs.
  const auto* entry = profile_->dictionary.find(object);
  if (entry == nullptr) return abort::kNoObject;
  const bool direction = transmit
                             ? entry->pdo == od::PdoMapping::tpdo || entry->pdo == od::PdoMapping::both
                             : (entry->pdo == od::PdoMapping::rpdo || entry->pdo == od::PdoMapping::both) &&
                                   od::writable(entry->access);
  if (!direction) return abort::kNotMappable;
  const auto size = od::size_of(entry->type);
  if (!size || bits != *size * 8) return abort::kNotMappable;
  return profile_->rules.pdo.whole_bytes && bits % 8 != 0 ? abort::kNotMappable : 0;
}

}  // namespace servoctl::sim
