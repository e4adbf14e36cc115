#include "canopen/nmt.hpp"

#include <array>
#include <utility>

#include "canopen/cob_id.hpp"

namespace servoctl::canopen {
namespace {

constexpr auto kCommands = std::to_array<std::pair<NmtCommand, std::string_view>>({
    {NmtCommand::start, "start"},
    {NmtCommand::stop, "stop"},
    {NmtCommand::enter_pre_operational, "preop"},
    {NmtCommand::reset_node, "reset"},
    {NmtCommand::reset_communication, "reset-comm"},
});

}  // namespace

std::string_view name(NmtState state) {
  switch (state) {
    case NmtState::initialising: return "boot-up";
    case NmtState::stopped: return "stopped";
    case NmtState::operational: return "operational";
    case NmtState::pre_operational: return "pre-operational";
  }
  return "unknown";
}

std::string_view name(NmtCommand command) {
  for (const auto& row : kCommands)
    if (row.first == command) return row.second;
  return "unknown";
}

std::optional<NmtCommand> parse_nmt_command(std::string_view name) {
  for (const auto& row : kCommands)
    if (row.second == name) return row.first;
  return std::nullopt;
}

NmtState state_after(NmtCommand command) {
  switch (command) {
    case NmtCommand::start: return NmtState::operational;
    case NmtCommand::stop: return NmtState::stopped;
    case NmtCommand::enter_pre_operational:
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication: return NmtState::pre_operational;
  }
  return NmtState::pre_operational;
}

can::Frame nmt_frame(NmtCommand command, std::uint8_t node) {
  return can::make_frame(kNmt, std::array{static_cast<std::uint8_t>(command), node});
}

std::optional<NmtMessage> parse_nmt(const can::Frame& frame) {
  if (frame.id != kNmt || frame.size != 2 || frame.extended || frame.remote || frame.error)
    return std::nullopt;
  for (const auto& row : kCommands)
    if (static_cast<std::uint8_t>(row.first) == frame.data[0]) return NmtMessage{row.first, frame.data[1]};
  return std::nullopt;
}

std::optional<ErrorControl> parse_error_control(const can::Frame& frame) {
  if (frame.id < kErrorControl + kFirstNode || frame.id > kErrorControl + kLastNode) return std::nullopt;
  if (frame.size != 1 || frame.extended || frame.remote || frame.error) return std::nullopt;
  ErrorControl out;
  out.node = static_cast<std::uint8_t>(frame.id - kErrorControl);
  out.state = static_cast<NmtState>(frame.data[0] & 0x7FU);
  // A guarding answer of a node that initialises would carry 0 too, but such a node does not answer.
  out.boot_up = out.state == NmtState::initialising;
  return out;
}

can::Frame guarding_request(std::uint8_t node) {
  can::Frame frame;
  frame.id = kErrorControl + node;
  frame.size = 1;
  frame.remote = true;
  return frame;
}

can::Frame heartbeat_frame(std::uint8_t node, NmtState state) {
  return can::make_frame(kErrorControl + node, std::array{static_cast<std::uint8_t>(state)});
}

}  // namespace servoctl::canopen
