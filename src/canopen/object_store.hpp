#pragma once

#include <cstddef>
#include <cstdint>

#include "base/bytes.hpp"
#include "base/object_address.hpp"

namespace servoctl::canopen {

/// The entries of a device, as an SDO server serves them, whatever wire it hangs on. All calls answer at
/// once; a refusal is an SDO abort code.
class ObjectStore {
 public:
  virtual ~ObjectStore() = default;
  /// Fills `out`; returns 0 or the abort code.
  virtual std::uint32_t read(ObjectAddress object, Bytes& out) = 0;
  /// Whether the entry takes any data at all: 0, or the abort code of an object that does not exist or is
  /// read-only. Asked before the data of a longer transfer are (CiA 301, 7.2.4.2.3).
  virtual std::uint32_t check_writable(ObjectAddress /*object*/) { return 0; }
  /// How many of the four data bytes of an expedited download are taken; `announced` by its command.
  virtual std::size_t expedited_size(ObjectAddress /*object*/, std::size_t announced) { return announced; }
  /// Returns 0 or the abort code; nothing is changed when it refuses.
  virtual std::uint32_t write(ObjectAddress object, ByteSpan data) = 0;
};

}  // namespace servoctl::canopen
