#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace servoctl::gateway {

/// Codes of CiA 309-3, table of internal errors, as far as they are answered here.
enum class Code : std::uint16_t {
  not_supported = 100,
  syntax = 101,
  internal_state = 102,  ///< The request was not processed; what is refused is refused with this.
  timeout = 103,
  no_default_network = 104,
  no_default_node = 105,
  unsupported_network = 106,
  unsupported_node = 107,
};

/// What a code of CiA 309-3 says; empty for one that it does not have.
std::string_view code_text(unsigned code);

/// Lines of answers, with their end (CR LF). As other stacks do, an error has its meaning behind a `#`.
std::string ok_line(std::uint32_t sequence);
std::string value_line(std::uint32_t sequence, std::string_view value);
/// `[1] ERROR:101 #Syntax error: why`
std::string error_line(std::uint32_t sequence, Code code, std::string_view why = {});
/// Of a transfer: the abort code where the node gave one, `0x05040000` where it did not answer,
/// `0x05040001` where its answer was none, else 102.
std::string failure_line(std::uint32_t sequence, const Error& error);

/// A line of an answer taken apart, as CANopenNode, lely-core and the above write them.
struct Answer {
  enum class Kind : std::uint8_t {
    ok,
    value,  ///< `text` has it.
    error,  ///< `number` is a code of CiA 309-3, `text` what is said of it.
    abort,  ///< `number` is an abort code of an SDO.
    event   ///< It answers no request: without a sequence number.
  };
  Kind kind = Kind::event;
  std::uint32_t sequence = 0;
  std::uint32_t number = 0;
  std::string text;
};

/// `line` is without its end. Empty for an empty line.
std::optional<Answer> parse_answer(std::string_view line);

}  // namespace servoctl::gateway
