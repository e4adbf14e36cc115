#pragma once

#include <span>
#include <string>

#include "canopen/nmt.hpp"
#include "canopen/node_watch.hpp"
#include "command/command.hpp"
#include "report/value.hpp"
#include "session/node_life.hpp"

/// What is asked, known and printed of an NMT command.
namespace servoctl::command {

bool is_reset(canopen::NmtCommand command);

/// Whether a heartbeat or a boot-up since `before` confirms the command. On a CAN bus.
bool is_confirmed(session::Session& session, const session::NodeLife& before, canopen::NmtCommand command);

/// Errc::timeout, with what may be the reason.
Error unconfirmed(const session::NodeLife& before, canopen::NmtCommand command,
                  const session::Heartbeats& heartbeats, const canopen::NodeWatch& watch);

/// One row a node: whether the command was confirmed if somebody waited for that, else whether the node is
/// there.
report::Table nmt_table(Context& context, std::span<const session::NodeLife> before,
                        canopen::NmtCommand command, bool waited);

/// The notice that values of the communication are lost by CiA 301.
std::string communication_goes();

/// What is to be answered before a reset.
std::string question_nmt(std::span<const std::uint8_t> nodes, canopen::NmtCommand command);

/// Adds what a reset of the communication has done where its boot-up was seen, and does by the standard
/// elsewhere.
void tell_reset(Context& context, std::span<const session::NodeLife> before, canopen::NmtCommand command,
                bool waited);

}  // namespace servoctl::command
