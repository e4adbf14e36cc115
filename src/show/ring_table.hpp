#pragma once

#include <span>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "report/value.hpp"
#include "session/ring_scan.hpp"
#include "show/identity.hpp"

namespace servoctl::show {

/// `SAFE-OP, error 0x001B sync manager watchdog: …`: what a slave says of its AL state. `PRE-OP` without an
/// error.
std::string al_text(const ethercat::AlStatus& al);
/// Fields of a state for JSON: `al_state`, `al_error`, `al_code` (a number), `al_text` (null without an
/// error).
report::Record al_fields(const ethercat::AlStatus& al);
/// The same fields where the state is not known: all null.
report::Record no_al_fields();

/// The slaves of a ring, one row each: place, addresses, identity, AL state, ports, families that fit, and
/// how the drives are. `nodes` are those that are shown, `conditions` is in their order, and empty where it
/// was not read. In text the identity in numbers (`in_full`) or the condition; in JSON both.
report::Table ring_table(const Desk& desk, const session::RingScan& ring, std::span<const std::uint8_t> nodes,
                         std::span<const Condition> conditions, std::span<const drive::Family> families,
                         bool in_full);

/// What is wrong with these slaves, a line each: another master, AL errors, SIIs, ports with errors.
std::vector<std::string> ring_notices(const session::RingScan& ring, std::span<const std::uint8_t> nodes);

}  // namespace servoctl::show
