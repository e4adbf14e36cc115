#include "sim/pdo_guard.hpp"

#include <algorithm>

#include "base/pdo_index.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/cob_id_rules.hpp"
#include "canopen/pdo.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::sim {
namespace abort = canopen::sdo_abort;
using drive::PdoRules;

namespace {

/// 1600h belongs to 1400h, 1A00h to 1800h.
std::uint16_t communication_of(PdoPlace place) {
  place.mapping = false;
  return index_of(place);
}

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
  const auto place = pdo_at(object.index);
  if (!place) return 0;
  if (place->mapping)
    return allowed(rules.mapping, communication_of(*place), operational) ? 0 : abort::kDeviceState;
  const auto value = load_le(data);
  if (object.sub == 1) {
    if (rules.parameters == PdoRules::When::not_operational && operational) return abort::kDeviceState;
    return check_cob_id(object, static_cast<std::uint32_t>(value));
  }
  if (!allowed(rules.parameters, object.index, operational)) return abort::kDeviceState;
  // 7.5.2.37: inhibit time and SYNC start value change only while the PDO is invalid.
  if ((object.sub == 3 || object.sub == 6) && place->direction == PdoDirection::transmit &&
      !rules.inhibit_while_valid && is_valid(object.index) && value != values_->number(object))
    return abort::kRange;
  const bool known = object.sub != 2 || knows_type(*place, static_cast<std::uint8_t>(value));
  return known ? 0 : abort::kRange;
}

/// CiA 301, tables 67 and 72: an RPDO has no types for remote frames, a TPDO only while bit 30 allows them.
bool PdoGuard::knows_type(const PdoPlace& place, std::uint8_t type) const {
  if (type <= 240) return true;
  if (type < 252) return false;
  if (place.direction == PdoDirection::receive) return type > 253;
  const auto& refused = profile_->rules.pdo.refused_types;
  if (std::find(refused.begin(), refused.end(), type) != refused.end()) return false;
  return type > 253 || (values_->number({index_of(place), 1}) & canopen::kPdoNoRtr) == 0;
}

std::uint32_t PdoGuard::check_cob_id(ObjectAddress object, std::uint32_t cob_id) const {
  const auto now = static_cast<std::uint32_t>(values_->number(object));
  if (((cob_id ^ now) & ~profile_->rules.pdo.cob_id_bits) != 0) return abort::kRange;
  const bool was_valid = (now & canopen::kPdoInvalid) == 0;
  const bool is_valid = (cob_id & canopen::kPdoInvalid) == 0;
  const bool basic = (cob_id & canopen::kPdoExtended) == 0;
  const auto can_id = cob_id & canopen::kPdoCobIdMask;
  if (is_valid && basic && (can_id > canopen::kCanId || canopen::is_restricted(can_id))) return abort::kRange;
  const bool stays_valid = was_valid && is_valid;
  return stays_valid && cob_id != now ? abort::kRange : 0;  // 7.5.2.33: bits 0 to 29 only while invalid.
}

}  // namespace servoctl::sim
