#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/bytes.hpp"

namespace servoctl::can {

/// States of a CAN controller (linux/can/netlink.h), as ISO 11898-1 has them.
enum class LinkHealth : std::uint8_t {
  error_active,
  error_warning,
  error_passive,
  bus_off,
  stopped,
  sleeping
};

std::string_view name(
    LinkHealth health);  ///< `error-active error-warning error-passive bus-off stopped sleeping`

/// What the kernel knows of a CAN interface.
struct LinkState {
  std::optional<std::uint32_t> bitrate;  ///< In bit/s; a virtual interface has none.
  std::optional<LinkHealth> health;
  std::optional<std::uint16_t>
      tx_errors;  ///< Error counters of the controller (ISO 11898-1, 12.1.4.2), where
  std::optional<std::uint16_t> rx_errors;  ///< its driver tells them.
};

/// Whether the kernel has a network interface of this name, of whatever kind.
bool is_interface(const std::string& name);

/// Asks the kernel (rtnetlink). Empty when it does not answer or there is no such interface; a virtual one
/// has a state without anything in it.
std::optional<LinkState> link_state(std::string_view interface_name);

/// The same from the kernel's answer, a RTM_NEWLINK message.
std::optional<LinkState> parse_link(ByteSpan message);

}  // namespace servoctl::can
