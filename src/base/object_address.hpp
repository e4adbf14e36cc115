#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace servoctl {

/// Index and sub-index of an entry of the object dictionary (CiA 301, 7.4.1).
struct ObjectAddress {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  auto operator<=>(const ObjectAddress&) const = default;
};

/// `0x6041:0`, `0x2000:65h`, `0x2000:0Ah`: index and sub-index in hexadecimal, the form that
/// parse_object_address() reads. A sub-index of which decimal would be another number ends with an h.
std::string to_string(ObjectAddress address);

/// Reads `0x6041`, `6041h`, `6041`, `0x6099:1`, `6099h.1`, `6099sub1`, in any case. Index and sub-index are
/// always hexadecimal, as in EDS files and in the manuals. Empty when the text is not of this form.
std::optional<ObjectAddress> parse_object_address(std::string_view text);

/// The sub-index of an address in digits alone that would be another number in decimal: `10` of `2001:10`.
std::optional<std::string_view> doubtful_sub(std::string_view text);

}  // namespace servoctl

template <>
struct std::hash<servoctl::ObjectAddress> {
  std::size_t operator()(servoctl::ObjectAddress a) const noexcept {
    return static_cast<std::size_t>(a.index) << 8U | a.sub;
  }
};
