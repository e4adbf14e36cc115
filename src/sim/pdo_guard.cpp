#include "sim/pdo_guard.hpp"

#include <algorithm>

#include "canopen/cob_id_rules.hpp"
#include "canopen/pdo.hpp"
#include "canopen/sdo_abort.hpp"
#include "drive/naming.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;
using drive::PdoRules;

namespace {

bool is_transmit(std::uint16_t index) { return index >= 0x1800; }

/// 1600h belongs to 1400h, 1A00h to 1800h.
std::uint16_t communication_of(std::uint16_t mapping) { return static_cast<std::uint16_t>(mapping - 0x200); }

}  // namespace

bool PdoGuard::is_valid(std::uint16_t communication_index) const {
  return (values_->number({communication_index, 1}) & canopen::kPdoInvalid) == 0;
}

bool PdoGuard::allowed(PdoRules::When when, std::uint16_t communication_index, bool operational) const {
  switch (when) {
    case PdoRules::When::always: return true;
    case PdoRules::When::invalid: return !is_valid(communication_index);
    case PdoRules::When::not_operational: return !operational;
  }
  return true;
}

std::uint32_t PdoGuard::check(ObjectAddress object, ByteSpan data, bool operational) const {
  const auto& rules = profile_->rules.pdo;
  const auto value = load_le(data);
  if (is_pdo_communication(object.index)) {
    if (object.sub == 1) {
      if (rules.parameters == PdoRules::When::not_operational && operational) return abort::kDeviceState;
      return check_cob_id(object, static_cast<std::uint32_t>(value));
    }
    if (!allowed(rules.parameters, object.index, operational)) return abort::kDeviceState;
    return object.sub == 2 && !knows_type(object.index, static_cast<std::uint8_t>(value)) ? abort::kRange : 0;
  }
  if (!is_pdo_mapping(object.index)) return 0;
  if (!allowed(rules.mapping, communication_of(object.index), operational)) return abort::kDeviceState;
  return check_mapping(object, value);
}

/// CiA 301, tables 67 and 72: an RPDO has no types for remote frames, a TPDO only while bit 30 allows them.
bool PdoGuard::knows_type(std::uint16_t index, std::uint8_t type) const {
  if (type <= 240) return true;
  if (type < 252) return false;
  if (!is_transmit(index)) return type > 253;
  const auto& refused = profile_->rules.pdo.refused_types;
  if (std::find(refused.begin(), refused.end(), type) != refused.end()) return false;
  return type > 253 || (values_->number({index, 1}) & canopen::kPdoNoRtr) == 0;
}

std::uint32_t PdoGuard::check_cob_id(ObjectAddress object, std::uint32_t cob_id) const {
  const auto now = static_cast<std::uint32_t>(values_->number(object));
  if (((cob_id ^ now) & ~profile_->rules.pdo.cob_id_bits) != 0) return abort::kRange;
  const bool was_valid = (now & canopen::kPdoInvalid) == 0;
  const bool is_valid = (cob_id & canopen::kPdoInvalid) == 0;
  const bool basic = (cob_id & canopen::kPdoExtended) == 0;
  if (is_valid && basic && canopen::is_restricted(cob_id & canopen::kPdoCobIdMask)) return abort::kRange;
  const bool stays_valid = was_valid && is_valid;
  return stays_valid && cob_id != now ? abort::kRange : 0;  // 7.5.2.33: bits 0 to 29 only while invalid.
}

std::uint32_t PdoGuard::check_mapping(ObjectAddress object, std::uint64_t value) const {
  if (object.sub == 0) return check_count(object.index, value);
  if (values_->number({object.index, 0}) != 0) return profile_->rules.pdo.mapped_abort;
  return value == 0 ? 0 : check_entry(object.index, static_cast<std::uint32_t>(value));
}

std::uint32_t PdoGuard::check_count(std::uint16_t index, std::uint64_t count) const {
  const auto& rules = profile_->rules.pdo;
  if (count > std::min(rules.most_entries, values_->last_sub(index))) return abort::kPdoLength;
  std::uint32_t bits = 0;
  for (std::uint8_t sub = 1; sub <= count; ++sub) {
    const auto entry = static_cast<std::uint32_t>(values_->number({index, sub}));
    if (entry == 0) return abort::kPdoLength;  // Nothing is mapped there.
    if (const auto code = check_entry(index, entry); code != 0) return code;
    bits += entry & 0xFFU;
  }
  return bits > rules.most_bits ? abort::kPdoLength : 0;
}

std::uint32_t PdoGuard::check_entry(std::uint16_t index, std::uint32_t mapping) const {
  const ObjectAddress object{static_cast<std::uint16_t>(mapping >> 16U),
                             static_cast<std::uint8_t>(mapping >> 8U & 0xFFU)};
  const auto bits = mapping & 0xFFU;
  if (object.index < 0x20) return is_transmit(index) ? abort::kNotMappable : 0;  // Dummy entries fill RPDOs.
  const auto* entry = profile_->dictionary.find(object);
  if (entry == nullptr) return abort::kNoObject;
  const bool direction = is_transmit(index)
                             ? entry->pdo == od::PdoMapping::tpdo || entry->pdo == od::PdoMapping::both
                             : (entry->pdo == od::PdoMapping::rpdo || entry->pdo == od::PdoMapping::both) &&
                                   od::writable(entry->access);
  if (!direction) return abort::kNotMappable;
  const auto size = od::size_of(entry->type);
  if (!size || bits != *size * 8) return abort::kNotMappable;
  return profile_->rules.pdo.whole_bytes && bits % 8 != 0 ? abort::kNotMappable : 0;
}

}  // namespace servoctl::sim
