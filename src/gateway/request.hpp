#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/object_address.hpp"
#include "base/result.hpp"

namespace servoctl::gateway {

/// What a line of CiA 309-3 asks for, as far as it is known here.
enum class Service : std::uint8_t {
  read,
  write,
  start,
  stop,
  preop,
  reset_node,
  reset_communication,
  set,  ///< A default, such as `set node 4`.
  info,
  help,
  other
};

/// A line of CiA 309-3 taken apart: `[7] 1 4 r 0x1017 0 u16`.
struct Request {
  std::optional<std::uint32_t> sequence;
  std::vector<std::uint64_t> numbers;  ///< Network and node, node, or nothing.
  std::vector<std::string> words;      ///< The command and what belongs to it.

  /// The command in lower case; empty when there is none.
  std::string verb() const;
  /// The word behind it in lower case; empty when there is none.
  std::string what() const;
};

/// `100`, `0x64`, without a sign; a leading zero does not mean octal.
std::optional<std::uint64_t> parse_unsigned(std::string_view word);

Request take_apart(std::span<const std::string> words);

/// A command is known by its words alone, whether as many follow as it needs or not: `start`, `preop`,
/// `reset comm`.
Service service_of(const Request& request);

/// The object behind the command of a read or write. Errc::usage: `'x' is not an index`.
Result<ObjectAddress> object_of(const Request& request);

}  // namespace servoctl::gateway
