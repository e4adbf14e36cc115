#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "session/supervision.hpp"
#include "settings/change.hpp"

namespace servoctl::settings {

/// A node whose heartbeat is to be watched.
struct HeartbeatWatch {
  std::uint8_t node = 0;  ///< The producer.
  Duration time{};        ///< Without a heartbeat of it; 0: it is watched no longer.
};

/// Reads a time of 1016h or 1017h: `100ms`, or `off`. Errc::usage for one that is no whole number of
/// milliseconds, or more than 65535 of them.
Result<Duration> parse_heartbeat_time(std::string_view text);
/// Reads `3=300ms` or `3=off`.
Result<HeartbeatWatch> parse_heartbeat_watch(std::string_view text);

/// The change of 1017h; without a family by CiA 301, 7.5.2.20 (U16, ms). Errc::usage where the family has
/// none, or its limits forbid the time.
Result<Change> producer_change(show::Desk& desk, std::uint8_t node, Duration time);

/// The changes of 1016h that make a drive watch these nodes too: the entry that a node has already, or else a
/// free one; a drive takes no second entry for a node (CiA 301, 7.5.2.19). Reads the drive, and 1017h of the
/// producers: what would never or always raise an alarm is told in the notices. Errc::usage where the family
/// has no 1016h, for its own number, and for one that appears twice; Errc::refused where no entry is free,
/// and where the time is no longer than the period of the producer.
Result<std::vector<Change>> consumer_changes(show::Desk& desk, std::uint8_t node,
                                             std::span<const HeartbeatWatch> watches);

}  // namespace servoctl::settings
