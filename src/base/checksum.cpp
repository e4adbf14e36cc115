#include "base/checksum.hpp"

#include "base/format.hpp"

namespace servoctl {

std::string Checksum::text() const { return formatted("fnv1a64:{:016x}", hash_); }

std::string checksum_of(std::string_view text) {
  Checksum sum;
  sum.add(text);
  return sum.text();
}

}  // namespace servoctl
