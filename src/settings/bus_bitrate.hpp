#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "drive/rules.hpp"
#include "session/bus_setup.hpp"
#include "session/session.hpp"

/// An interface of the kernel that goes to another bitrate together with those on its bus.
namespace servoctl::settings {

/// How an interface follows its drives.
struct BitrateSwitch {
  std::uint32_t bitrate = 0;                    ///< The new one, in bit/s.
  std::unique_ptr<can::LinkControl> link = {};  ///< Null: the bus has no bitrate that could be set.
  can::LinkState before = {};
  std::string why_not = {};  ///< A sentence: why it is left alone; empty: it follows.
  /// What restarts all drives of it at once, of whatever families.
  drive::NmtRules::Restart restart = drive::NmtRules::Restart::power_cycle;

  bool follows() const { return link != nullptr && why_not.empty(); }
};

/// Whether an interface can be taken there at all: a controller, with another bitrate, and the right to
/// change it. `link` may be null. Errors of the interface.
Result<BitrateSwitch> plan_bus_bitrate(std::unique_ptr<can::LinkControl> link, std::uint32_t bitrate,
                                       const std::optional<bool>& may_change);

/// Takes the interface there, down and up, and the session with it.
Result<void> take_to(session::Session& session, BitrateSwitch& plan, std::uint32_t bitrate);

/// For when nobody answers at the new bitrate: whether somebody `answers` at the old one, where the interface
/// stays then; else it is at the new one again, or an error of the interface.
Result<bool> take_back(session::Session& session, BitrateSwitch& plan, const std::function<bool()>& answers);

/// How the bitrate before is called.
std::string old_bitrate_text(const BitrateSwitch& plan);

/// What happens behind an activation by LSS, for a question, and the commands of it, for a dry run.
std::string lss_switch_text(const BitrateSwitch& plan);
std::string lss_switch_commands(const BitrateSwitch& plan);

}  // namespace servoctl::settings
