#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "can/frame.hpp"

namespace servoctl::canopen {

/// Node control commands (CiA 301, 7.2.8.2.1).
enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};

/// State of the NMT slave as heartbeat and node guarding carry it (CiA 301, 7.2.8.3).
enum class NmtState : std::uint8_t {
  initialising = 0x00,  ///< Carried by the boot-up message only.
  stopped = 0x04,
  operational = 0x05,
  pre_operational = 0x7F,
};

std::string_view name(
    NmtState state);  ///< `boot-up stopped operational pre-operational`, `unknown` for other values.
std::string_view name(NmtCommand command);  ///< `start stop preop reset reset-comm`
std::optional<NmtCommand> parse_nmt_command(std::string_view name);

/// The state a node reaches by the command; pre_operational after a reset, when it has booted.
NmtState state_after(NmtCommand command);

/// Commands a node (1..127), or all with 0, to change state.
can::Frame nmt_frame(NmtCommand command, std::uint8_t node);

/// A node control message taken apart.
struct NmtMessage {
  NmtCommand command = NmtCommand::start;
  std::uint8_t node = 0;  ///< 0: all.
};
std::optional<NmtMessage> parse_nmt(const can::Frame& frame);

/// Boot-up, heartbeat or the answer of node guarding: the node and its state. The toggle bit of guarding is
/// dropped.
struct ErrorControl {
  std::uint8_t node = 0;
  NmtState state = NmtState::initialising;
  bool boot_up = false;
};
std::optional<ErrorControl> parse_error_control(const can::Frame& frame);
can::Frame heartbeat_frame(std::uint8_t node, NmtState state);
/// The remote frame by which a master asks a guarded node for its state (CiA 301, 7.2.8.3.2.1).
can::Frame guarding_request(std::uint8_t node);

}  // namespace servoctl::canopen
