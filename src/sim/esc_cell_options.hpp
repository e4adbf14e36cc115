#pragma once

#include "base/result.hpp"
#include "base/time.hpp"
#include "sim/cell_spec.hpp"
#include "sim/esc_cell.hpp"
#include "sim/esc_sii_image.hpp"

namespace servoctl::sim {

/// What `sii=checksum|blank|cut-short|mailboxes|mute` says is wrong with the SII of all slaves; Errc::usage.
Result<SiiFault> sii_fault_of(const CellSpec& spec);

/// Applies an option of a ring to its cell, to all slaves or to the wire. Times count from `now`; positions
/// from 1.
///   fault=CODE@TIME, counts=N, panel=NAME=VALUE  as on CAN
///   delay=TIME       answers of the mailboxes come this late
///   silent=TIME      from then on frames do not come back
///   lose=N           every Nth frame does not come back; what it asked for was done
///   short=N          every Nth frame comes back with working counters that are one too low
///   mailbox=full     what the master writes into a mailbox stays there
///   emergency=N      before each of N answers an emergency comes
///   fall=TIME, fall=CODE@TIME      out of OP to SAFE-OP, with this AL status code (1Ah)
///   free-run=no      OP only with SYNC0
///   clock=32         distributed clocks of 32 bits
///   lie=WORD,WORD    deviations (kRingLies) that begin when the drive was enabled; lie-after=TIME: so long
///   after
///                    that; lie-for=TIME: and end after so long
///   power=POSITION@OFF-ON, cut=POSITION@FROM-TO   a slave without power, or the cable in front of it cut;
///                    without the second time it stays so
/// Errc::usage for an unknown key, or a value that is none.
Result<void> apply_option(const CellSpec& spec, const CellSpec::Option& option, EscCell& cell, TimePoint now);

}  // namespace servoctl::sim
