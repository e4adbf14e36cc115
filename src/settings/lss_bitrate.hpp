#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "session/lss.hpp"
#include "settings/bus_bitrate.hpp"
#include "show/desk.hpp"

namespace servoctl::settings {

/// The bitrate that LSS slaves are to have.
struct LssBitrateChange {
  bool all = false;                            ///< Every one that answers; `address` is of no matter then.
  std::optional<canopen::LssAddress> address;  ///< Empty: the only slave on the bus.
  std::uint8_t index = 0;                      ///< Of table 0, or canopen::kLssAutomaticBitrate.
  std::optional<std::uint32_t> bitrate = {};   ///< In bit/s; empty: they find it themselves.
  bool keep = false;
  std::optional<std::uint16_t> delay_ms = {};  ///< They change after it, and talk after twice of it.
};

/// What is asked of the slaves that were selected, in this order.
std::vector<canopen::LssRequest> lss_bitrate_requests(const LssBitrateChange& change);

/// Whether the interface can go with the slaves: it is left alone as plan_bus_bitrate() says, where they find
/// the bitrate themselves, and where the delay is too short. `link` may be null. Sends nothing.
Result<BitrateSwitch> plan_lss_switch(std::unique_ptr<can::LinkControl> link, const LssBitrateChange& change,
                                      const std::optional<bool>& may_change = can::may_change_links());

/// Leaves the interface alone where somebody on the bus is not one of those that change, by asking who they
/// are: slaves are in the configuration state for it, and all are back to waiting behind it. Asks nobody
/// where the interface does not follow. Errors of the bus.
Result<void> leave_nobody_behind(session::Session& session, const LssBitrateChange& change,
                                 BitrateSwitch& plan);

/// What came of it.
struct LssBitrateOutcome {
  std::optional<canopen::LssAddress> address;  ///< Of the one.
  std::size_t slaves = 0;                      ///< That have taken it.
  std::optional<Error> error = {};             ///< Of what followed: what the slaves have taken holds.
};

/// Sets the bitrate, stores it where that is wanted, and activates it: only when each that answered before
/// has confirmed. Where the interface follows, it changes between the two silences; then the slaves are
/// looked for. Where none answers at the new bitrate and some at the old one it goes back to them. From the
/// activation until the interface has changed Ctrl-C is not heard. Nobody is asked.
Result<LssBitrateOutcome> set_lss_bitrate(show::Desk& desk, const LssBitrateChange& change,
                                          BitrateSwitch& plan);

}  // namespace servoctl::settings
