#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/time.hpp"
#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::session {

/// One node whose heartbeat a drive watches: an entry of 1016h (CiA 301, 7.5.2.19).
struct WatchedNode {
  std::uint8_t sub = 0;   ///< Of 1016h.
  std::uint8_t node = 0;  ///< 0: the entry is free.
  Duration time{};        ///< Whole milliseconds.
};

/// What the objects of a node say of who watches whom. What is empty the drive does not have.
struct Supervision {
  std::uint8_t node = 0;
  std::optional<Duration> heartbeat;                ///< 1017h; 0: it sends none.
  std::vector<WatchedNode> entries;                 ///< All of 1016h, free ones as well.
  std::optional<Duration> guard_time;               ///< 100Ch
  std::optional<std::uint8_t> life_time_factor;     ///< 100Dh
  std::optional<std::uint16_t> abort_option;        ///< 6007h
  std::optional<std::uint8_t> communication_error;  ///< 1029h:01
  std::optional<std::uint64_t> guarding_alarm;      ///< NmtRules::guarding_alarm

  /// Life guarding is set: 100Ch times 100Dh; zero where it is not.
  Duration life_time() const { return guard_time.value_or(Duration{}) * life_time_factor.value_or(0); }
};

/// Reads it, all nodes at the same time: the objects that the family's data has. A node that does not answer
/// has an error instead.
std::vector<Result<Supervision>> read_supervision(Session& session, const drive::Profile& profile,
                                                  std::span<const std::uint8_t> nodes);

/// The value of an entry of 1016h; of node 0 or no time: 0, which frees it.
std::uint32_t consumer_entry(std::uint8_t node, Duration time);

}  // namespace servoctl::session
