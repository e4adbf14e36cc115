#pragma once

#include <array>
#include <cstdint>
#include <optional>
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
/// Err-9, Err-15, …` where several share it, `Sensor (not among the faults of gsd600)` where CiA 402 alone
/// lists it, else the class of CiA 301. `profile` may be null.
std::string fault_words(const drive::Profile* profile, bool chinese, std::uint16_t code,
                        const std::array<std::uint8_t, 5>& vendor = {});

/// The same for the alarm number of an object of the family's own, which the classes of CiA 301 are not for.
std::string alarm_words(const drive::Profile* profile, bool chinese, std::uint16_t code);

/// What a drive says of its fault, by 603Fh and the statusword; either may be unknown.
struct ToldFault {
  bool known = false;                 ///< Whether anything tells it.
  std::optional<std::uint16_t> code;  ///< Of 603Fh, where that has one.
  std::string text;                   ///< In words; empty where there is no fault.

  /// `none`, `0x7300 Overspeed` cut to `most` columns of words (0: without), what reads the alarm of a drive
  /// in fault that has no code there; nothing where nothing tells it.
  report::Value cell(std::size_t most) const;
  /// `code` and `text`; null where there is no fault, or nothing tells it. `code` is null where the drive is
  /// in fault and has no code to tell.
  report::Value record() const;
};
ToldFault told_fault(const drive::Profile* profile, bool chinese, std::optional<std::uint16_t> code,
                     std::optional<std::uint16_t> statusword);

}  // namespace servoctl::show
