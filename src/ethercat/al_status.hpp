#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.hpp"

namespace servoctl::ethercat {

/// States of a slave (ETG.1000.6, 6.4.1), as its registers 0120h and 0130h have them.
enum class AlState : std::uint8_t { none = 0, init = 1, preop = 2, boot = 3, safeop = 4, op = 8 };

/// `INIT PRE-OP BOOT SAFE-OP OP`; `unknown state` for anything else.
std::string_view name(AlState state);

/// What a slave says of its state: registers 0130h to 0135h.
struct AlStatus {
  AlState state = AlState::none;  ///< May hold a number that is no state.
  bool error = false;             ///< It refused or left a state, and nobody has acknowledged that.
  std::uint16_t code = 0;         ///< Why; see al_status_text().

  bool operator==(const AlStatus&) const = default;
};

/// Takes the 6 bytes from 0130h on apart; fewer are none.
AlStatus parse_al_status(ByteSpan registers);

/// AL status codes from here on are the vendor's own (ETG.1000.6, table 11).
constexpr std::uint16_t kFirstOfVendor = 0x8000;

/// What an AL status code (0134h) says, in plain words (ETG.1000.6, table 11; ETG.1020, 5.7): a phrase
/// without a full stop.
std::string al_status_text(std::uint16_t code);
/// What to do about it; empty when the code leaves nothing to say.
std::string al_status_hint(std::uint16_t code);

/// The codes that have a text, in ascending order.
std::vector<std::uint16_t> al_status_codes();

/// The next state on the way from one to another: up one step at a time, down at once, BOOT from and to INIT
/// only (ETG.1000.6, 6.4.1). `target` itself when they are the same.
AlState next_al_state(AlState from, AlState target);

}  // namespace servoctl::ethercat
