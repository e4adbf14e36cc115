#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace servoctl {

/// A checksum that tells whether a text was changed by mistake: FNV-1a of 64 bits. It is no proof against
/// whoever changes it on purpose.
class Checksum {
 public:
  void add(std::string_view text) {
    for (const char c : text) {
      hash_ ^= static_cast<unsigned char>(c);
      hash_ *= 0x100'0000'01B3U;
    }
  }
  /// `fnv1a64:` and 16 hexadecimal digits.
  std::string text() const;

 private:
  std::uint64_t hash_ = 0xCBF2'9CE4'8422'2325U;
};

/// The checksum of one text.
std::string checksum_of(std::string_view text);

}  // namespace servoctl
