#pragma once

#include <functional>
#include <optional>
#include <string>

#include "session/session.hpp"
#include "traffic/finding.hpp"

/// Looks at a bus and says what is wrong with it.
namespace servoctl::traffic {

struct DoctorOptions {
  Duration listen = std::chrono::seconds(2);
  bool active = false;                   ///< Asks all nodes for 1000h; else nothing is sent on CAN.
  std::function<bool()> cancelled = {};  ///< Ends the listening early, which is no error.
  /// Told while it listens to an interface how much of that is done; may be empty.
  std::function<void(double share, TimePoint begin, TimePoint now)> told = {};
};

/// A CAN interface of the kernel: what is set, and what is heard. Errc::bus when it goes away meanwhile.
Result<Findings> examine_link(const std::string& name, const DoctorOptions& options);

/// A bus that is open: a ring by its registers, `local:` and `sim:` by what is heard. Errc::bus when it is
/// lost.
Result<Findings> examine(session::Session& session, const DoctorOptions& options);

/// Where this machine has no CAN interface.
Findings examine_machine();

}  // namespace servoctl::traffic
