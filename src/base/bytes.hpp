#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

/// The first `bytes.size()` (at most 8) bytes as an unsigned number, little endian as everywhere in CANopen.
std::uint64_t load_le(ByteSpan bytes);

/// The low `size` (0..8) bytes of `value`, little endian.
Bytes store_le(std::uint64_t value, std::size_t size);

/// Writes the low bytes of `value` into `out`, little endian.
void store_le(std::uint64_t value, std::span<std::uint8_t> out);

/// `64 00 FF`: two upper-case digits a byte, separated by `separator`.
std::string to_hex(ByteSpan bytes, std::string_view separator = " ");

/// The same bytes as characters, for what writes text to a port.
std::string_view as_text(ByteSpan bytes);

/// Reads `6400FF` or `64 00 ff`; empty when a digit is missing or foreign.
std::optional<Bytes> parse_hex_bytes(std::string_view text);

}  // namespace servoctl
