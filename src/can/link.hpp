#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// What the driver has counted since it was loaded (`struct can_device_stats`).
struct LinkHistory {
  std::uint32_t bus_errors = 0;
  std::uint32_t error_warning = 0;  ///< How often it became so; the next two as well.
  std::uint32_t error_passive = 0;
  std::uint32_t bus_off = 0;
  std::uint32_t arbitration_lost = 0;
  std::uint32_t restarts = 0;
};

/// Frames since the interface was made.
struct LinkTraffic {
  std::uint64_t received = 0;
  std::uint64_t sent = 0;
  std::uint64_t receive_errors = 0;
  std::uint64_t send_errors = 0;
  std::uint64_t receive_dropped = 0;
  std::uint64_t send_dropped = 0;
  std::uint64_t overrun = 0;  ///< Lost in the controller: nobody took them in time.
};

/// What the kernel knows of a CAN interface.
struct LinkState {
  std::optional<std::uint32_t> bitrate;  ///< In bit/s; a virtual interface has none.
  std::optional<LinkHealth> health;
  std::optional<std::uint16_t>
      tx_errors;  ///< Error counters of the controller (ISO 11898-1, 12.1.4.2), where
  std::optional<std::uint16_t> rx_errors;  ///< its driver tells them.

  std::string kind;                           ///< `can`, or one without a bitrate: `vcan`, `vxcan`.
  bool up = false;                            ///< As it was told to be.
  std::optional<std::uint16_t> sample_point;  ///< In thousandths of a bit.
  std::uint32_t quanta = 0;                   ///< Time quanta of a bit; 0: not told.
  std::uint32_t clock = 0;                    ///< Of the controller in Hz; 0: not told.
  std::optional<std::uint32_t> restart_ms;    ///< Comes back so long after a bus-off; 0: not by itself.
  std::uint32_t queue_length = 0;             ///< Frames that may wait to be sent.
  bool listen_only = false;
  bool loopback = false;
  std::optional<bool> can_listen_only;       ///< Whether its driver has that mode, where it is told.
  std::vector<std::uint32_t> bitrates;       ///< The only ones it has; empty: what its clock can make.
  std::optional<std::uint16_t> termination;  ///< Its own, switched by the driver, in ohms; 0: it is off.
  std::optional<LinkHistory> history;
  LinkTraffic traffic;
};

/// Whether the kernel has a network interface of this name, of whatever kind.
bool is_interface(const std::string& name);

/// Asks the kernel (rtnetlink). Empty when it does not answer or there is no such interface; a virtual one
/// has a state without anything of a controller in it.
std::optional<LinkState> link_state(std::string_view interface_name);

/// The same from the kernel's answer, a RTM_NEWLINK message.
std::optional<LinkState> parse_link(ByteSpan message);

/// The driver of the adapter behind an interface, as `kvaser_pci`; empty where there is none.
std::string link_driver(const std::string& name);

/// How many sockets of this machine take frames from the interface (/proc/net/can): those of other programs,
/// and of this one. Sockets that only send are not known. One at the least where the kernel hides which.
std::size_t link_receivers(const std::string& name);
/// The same from the text of the kernel's lists.
std::size_t count_receivers(std::string_view lists, std::string_view name);

}  // namespace servoctl::can
