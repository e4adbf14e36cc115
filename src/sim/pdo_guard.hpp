#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "drive/profile.hpp"
#include "sim/object_values.hpp"

namespace servoctl::sim {

/// What a drive allows to be written to its PDO parameters (CiA 301, 7.5.2.33 to 7.5.2.38, narrowed by the
/// family's rules): which bits of the COB-ID, which transmission types, what may be mapped and when.
class PdoGuard {
 public:
  PdoGuard(const drive::Profile& profile, const ObjectValues& values)
      : profile_(&profile), values_(&values) {}

  /// Abort code, or 0 for objects that are no PDO parameters and for writes that are allowed.
  std::uint32_t check(ObjectAddress object, ByteSpan data, bool operational) const;

 private:
  std::uint32_t check_cob_id(ObjectAddress object, std::uint32_t cob_id) const;
  bool knows_type(std::uint16_t index, std::uint8_t type) const;
  std::uint32_t check_mapping(ObjectAddress object, std::uint64_t value) const;
  std::uint32_t check_count(std::uint16_t index, std::uint64_t count) const;
  std::uint32_t check_entry(std::uint16_t index, std::uint32_t mapping) const;
  bool is_valid(std::uint16_t communication_index) const;
  bool allowed(drive::PdoRules::When when, std::uint16_t communication_index, bool operational) const;

  const drive::Profile* profile_;
  const ObjectValues* values_;
};

}  // namespace servoctl::sim
