#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "base/time.hpp"
#include "canopen/transfer.hpp"
#include "gateway/line_reader.hpp"
#include "gateway/value.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// What a gateway keeps of one of its clients.
struct GatewayClient {
  /// A transfer that it asked for, and that is answered before its next line is looked at.
  struct Order {
    SdoRequest request;
    std::uint32_t sequence = 0;
    gateway::ValueType type;
    bool started = false;
  };

  gateway::LineReader in;
  std::string out;  ///< Answers that it has not been given yet.
  std::optional<Order> order;
  std::optional<std::uint8_t> node;  ///< By `set node`.
  Duration timeout = std::chrono::milliseconds(500);
  bool is_cut = false;      ///< It ended behind a line without an end.
  bool blocks = false;      ///< By `set sdo_block`.
  bool ended = false;       ///< It says nothing more.
  std::size_t refused = 0;  ///< Requests that were refused because it may only read.
};

}  // namespace servoctl::session
