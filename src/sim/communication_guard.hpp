#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "base/object_address.hpp"
#include "sim/object_values.hpp"

namespace servoctl::sim {

/// What a drive allows to be written to the communication objects that are no PDO parameters: the COB-IDs of
/// SYNC, TIME and EMCY, the SYNC counter, the heartbeats it watches (CiA 301, 7.5.2.5 to 7.5.2.22). It
/// produces neither SYNC nor TIME, and its CAN-IDs have 11 bits.
class CommunicationGuard {
 public:
  explicit CommunicationGuard(const ObjectValues& values) : values_(&values) {}

  /// Abort code, or 0 for other objects and for writes that are allowed. What an object holds already may
  /// always be written.
  std::uint32_t check(ObjectAddress object, ByteSpan data) const;

 private:
  std::uint32_t check_time(std::uint32_t cob_id) const;
  std::uint32_t check_emergency(std::uint32_t cob_id) const;
  std::uint32_t check_overflow(std::uint64_t value) const;
  std::uint32_t check_consumer(ObjectAddress object, std::uint32_t value) const;

  const ObjectValues* values_;
};

}  // namespace servoctl::sim
