#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "settings/address_change.hpp"
#include "settings/bus_bitrate.hpp"
#include "show/desk.hpp"

/// The interface of a bus goes to another bitrate together with all drives of the bus.
namespace servoctl::settings {

/// Finds out whether the interface can follow; only reads, and listens as nodes_in_use() does. It is left
/// alone where the right to change it is missing, where somebody uses the bus who would be left behind, and
/// where drives that have to be switched off and on are not waited for. `link` may be null. Errors of the
/// bus.
Result<BitrateSwitch> plan_switch(show::Desk& desk, std::unique_ptr<can::LinkControl> link,
                                  std::span<const AddressChange> changes, std::uint32_t bitrate,
                                  const AddressOptions& options,
                                  const std::optional<bool>& may_change = can::may_change_links());

/// What happens behind the writes, for a question: `then all are restarted together (NMT reset node), and
/// can0 goes from 250 kbit/s to 500 kbit/s`; and the messages and commands of it, for a dry run.
std::string switch_text(const BitrateSwitch& plan);
std::string switch_commands(const BitrateSwitch& plan);

/// What somebody has to do by hand where the interface stays, as notices: why it does, and the steps.
void tell_bitrate_by_hand(show::Desk& desk, const BitrateSwitch& plan,
                          std::span<const AddressChange> changes);

/// Restarts the drives, all with one NMT command or by asking somebody to switch them off and on, takes the
/// interface to the bitrate when they are gone from the old one, and looks for each. Where none is found and
/// some answer at the old bitrate, the interface goes back to it. Writes into `outcomes`, one for each of
/// `changes`, what came of each drive; Errc::interrupted and errors of the bus and of the interface are those
/// of all.
void follow_bitrate(show::Desk& desk, BitrateSwitch& plan, std::span<const AddressChange> changes,
                    std::span<AddressOutcome> outcomes, const AddressOptions& options);

}  // namespace servoctl::settings
