#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "drive/profile.hpp"
#include "sim/object_values.hpp"

namespace servoctl::sim {

/// What a drive can exchange as process data, on any wire: which of its objects an entry of 1600h to 17FFh
/// and 1A00h to 1BFFh may name, with how many bits, and how many of them there may be (CiA 301, 7.5.2.36 and
/// 7.5.2.38, narrowed by the family's rules). When they may be written is the wire's to say.
class MappingGuard {
 public:
  MappingGuard(const drive::Profile& profile, const ObjectValues& values)
      : profile_(&profile), values_(&values) {}

  /// Abort code, or 0 for objects that are no mapping and for writes that are allowed.
  std::uint32_t check(ObjectAddress object, ByteSpan data) const;

 private:
  std::uint32_t check_count(std::uint16_t index, std::uint64_t count) const;
  std::uint32_t check_entry(std::uint16_t index, std::uint32_t mapping) const;

  const drive::Profile* profile_;
  const ObjectValues* values_;
};

}  // namespace servoctl::sim
