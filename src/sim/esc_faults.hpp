#pragma once

#include <cstdint>

#include "base/time.hpp"
#include "sim/esc_states.hpp"

namespace servoctl::sim {

/// Ways in which an EtherCAT slave misbehaves; all off at first. What goes wrong on the wire is RingFaults';
/// what is wrong with its SII, EscSlave::Options'.
struct EscFaults {
  bool mailbox_stays_full = false;     ///< The processor does not take what the master writes.
  Duration answer_delay{};             ///< Answers of the mailbox come this late.
  std::uint32_t emergencies = 0;       ///< Before so many answers an emergency comes (code FF00h).
  std::uint32_t unanswered = 0;        ///< So many requests are carried out and not answered.
  bool uncounted_answers = false;      ///< Their counter is 0.
  bool no_repeat = false;              ///< Asked for a message again, it confirms and has none.
  bool refuses_free_run = false;       ///< OP only with SYNC0 (AL status 0027h).
  bool refuses_mapped_writes = false;  ///< In OP it takes no SDO of what its outputs carry (0601 0006h).
  bool sleeps_outside_op = false;      ///< Its drive state machine runs in OP only: 6041h reads 0 elsewhere.
  bool silent_mailbox = false;         ///< Requests are taken, and neither carried out nor answered.
  bool withholds_inputs = false;   ///< Outputs are taken, inputs are not returned: the counter is 2, not 3.
  bool senseless_counter = false;  ///< The working counter of process data is FFFFh.
  bool frozen_inputs = false;      ///< Inputs stay as they were.
  bool frozen_outputs = false;     ///< Outputs are counted and not carried out.
  bool frozen_state = false;       ///< 0130h stays as it was, whatever state the slave goes to.
  Duration state_delay{};          ///< From the request of a state to what comes of it.
};

/// It leaves a state by itself.
struct PlannedFall {
  TimePoint time = kNever;
  EscState to = EscState::safe_op;
  std::uint16_t code = 0x001A;  ///< Of a synchronisation error.
};

}  // namespace servoctl::sim
