#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "base/bytes.hpp"
#include "base/result.hpp"

namespace servoctl::session {

/// The unsigned number that an object holds; empty where it was not read, or has none or more than `most`
/// (1..8) bytes.
inline std::optional<std::uint64_t> number_in(const Result<Bytes>& answer, std::size_t most = 8) {
  if (!answer || answer->empty() || answer->size() > most) return std::nullopt;
  return load_le(*answer);
}

/// The same, of an object that has up to 32 bits.
inline std::optional<std::uint32_t> u32_in(const Result<Bytes>& answer) {
  const auto number = number_in(answer, 4);
  return number ? std::optional(static_cast<std::uint32_t>(*number)) : std::nullopt;
}

/// The text that an object holds, up to the first NUL; empty where it was not read.
inline std::string text_in(const Result<Bytes>& answer) {
  if (!answer) return {};
  return {answer->begin(), std::find(answer->begin(), answer->end(), std::uint8_t{0})};
}

}  // namespace servoctl::session
