#pragma once

#include <span>

#include "session/rehearsal.hpp"
#include "show/desk.hpp"

namespace servoctl::show {

/// The frame that begins to send a message: `601#2B40600006000000`.
std::string frame_text(const session::PlannedMessage& message);

/// Whether what is planned goes out as frames of CAN; without a network it is taken to.
bool is_sent_as_frames(const Desk& desk);

/// False where the message is a write that would not be sent because it raises an access alarm
/// (session::refusal_of()); the refusal is then an error of the command.
bool would_be_sent(Desk& desk, const session::PlannedMessage& message);

/// What --dry-run shows of commands that change a drive: `node object name when frame`, one row a message. On
/// EtherCAT there are no such frames, and `value` says what is written; on Modbus `frame` is its bytes.
report::Value planned_messages(Desk& desk, std::span<const session::PlannedMessage> messages);

}  // namespace servoctl::show
