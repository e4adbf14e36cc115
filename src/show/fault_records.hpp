#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "drive/profile.hpp"
#include "report/value.hpp"

/// Faults of a family as they are shown.
namespace servoctl::show {

/// Faults as a table: `fault list`, and what a code may stand for.
report::Table fault_table(std::span<const drive::Fault* const> faults, bool chinese);

/// One fault in full: what a terminal's width would cut from the table. In JSON as a row of the table.
report::Record fault_record(const drive::Fault& fault, bool chinese);

/// So many faults are told in full; more are a table.
inline constexpr std::size_t kFewFaults = 3;

/// A code in words: `Er12-2 Overcurrent` where the code or the vendor bytes tell which alarm it is, `one of
/// Err-9, Err-15, …` where several share it, else the class of CiA 301. `profile` may be null.
std::string fault_words(const drive::Profile* profile, bool chinese, std::uint16_t code,
                        const std::array<std::uint8_t, 5>& vendor = {});

}  // namespace servoctl::show
