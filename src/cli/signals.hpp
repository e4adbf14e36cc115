#pragma once

namespace servoctl::cli {

/// Catches SIGINT, SIGTERM and SIGHUP so that every wait ends in order; SIGPIPE is ignored. A second SIGINT
/// while the first is still being worked on ends the process at once, unless a drive is energised.
void install_signal_handlers();

/// Told true while a drive is energised: no number of signals ends the process then, because it has to stop
/// the drive first.
void protect_from_signals(bool energised);

/// Whether one of them came since the last clear_interrupt().
bool interrupted();
/// Whether SIGTERM or SIGHUP came: the program has to end, not only what it is doing.
bool terminated();
void clear_interrupt();

}  // namespace servoctl::cli
