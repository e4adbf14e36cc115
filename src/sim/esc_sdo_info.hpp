#pragma once

#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "drive/profile.hpp"

namespace servoctl::sim {

/// SDO information of CoE (ETG.1000.6, 5.6.3): which objects a slave has and what they are, from its
/// dictionary. It knows no mailbox.
class EscSdoInfo {
 public:
  /// `profile` outlives it.
  EscSdoInfo(const drive::Profile& profile, std::uint8_t node) : profile_(&profile), node_(node) {}

  /// `request` begins with the operation code and has 6 bytes at least; the answer in pieces of `most` bytes
  /// at most.
  std::vector<Bytes> on_request(ByteSpan request, std::size_t most) const;

 private:
  /// What stands behind the four bytes of its head, or the abort code.
  struct Answer {
    std::uint8_t operation = 0;
    Bytes data = {};
    std::uint32_t abort = 0;
  };

  Answer answer(ByteSpan request) const;
  Answer list(std::uint16_t kind) const;
  Bytes count_lists() const;
  Answer describe_object(std::uint16_t index) const;
  Answer describe_entry(ByteSpan request) const;

  const drive::Profile* profile_;
  std::uint8_t node_;
};

}  // namespace servoctl::sim
