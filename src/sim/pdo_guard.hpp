#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "base/pdo_index.hpp"
#include "drive/profile.hpp"
#include "sim/object_values.hpp"

namespace servoctl::sim {

/// What a drive on CAN allows to be written to its PDO parameters (CiA 301, 7.5.2.33 to 7.5.2.38, narrowed by
/// the family's rules): which bits of the COB-ID, which transmission types, and when it may be mapped anew.
/// What may be mapped is MappingGuard's.
class PdoGuard {
 public:
  PdoGuard(const drive::Profile& profile, const ObjectValues& values)
      : profile_(&profile), values_(&values) {}

  /// Abort code, or 0 for objects that are no PDO parameters and for writes that are allowed.
  std::uint32_t check(ObjectAddress object, ByteSpan data, bool operational) const;

 private:
  std::uint32_t check_cob_id(ObjectAddress object, std::uint32_t cob_id) const;
  bool knows_type(const PdoPlace& place, std::uint8_t type) const;
  bool is_valid(std::uint16_t communication_index) const;
  bool allowed(drive::PdoRules::When when, std::uint16_t communication_index, bool operational) const;

  const drive::Profile* profile_;
  const ObjectValues* values_;
};

}  // namespace servoctl::sim
