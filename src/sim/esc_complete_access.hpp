#pragma once

#include <cstdint>

#include "base/bytes.hpp"
#include "canopen/object_store.hpp"
#include "drive/profile.hpp"

namespace servoctl::sim {

/// All sub-indices of an object as one piece of data (ETG.1000.6, 5.6.2: complete access): sub-index 0 takes
/// 16 bits, the others stand one behind the other. Every object of a drive here has whole bytes.
class EscCompleteAccess {
 public:
  /// Both outlive it.
  EscCompleteAccess(const drive::Profile& profile, canopen::ObjectStore& store)
      : profile_(&profile), store_(&store) {}

  /// From sub-index 0 or 1. 0, or the abort code.
  std::uint32_t read(std::uint16_t index, std::uint8_t from, Bytes& out);
  /// Nothing is written where the length does not fit; else all of it until one is refused.
  std::uint32_t write(std::uint16_t index, std::uint8_t from, ByteSpan data);

 private:
  std::size_t size_of(const od::Entry& entry) const;

  const drive::Profile* profile_;
  canopen::ObjectStore* store_;
};

}  // namespace servoctl::sim
