#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "can/trace.hpp"

/// Files of recorded frames: candump, .asc, .trc, pcap, pcapng, BLF. What a file is, its beginning tells.
namespace servoctl::can {

/// Takes a frame; false: no more.
using TakeLogFrame = std::function<bool(const LogFrame& frame)>;

/// Where a file stops making sense: it was cut short, or tells lengths that cannot be.
struct RecordingDamage {
  std::uint64_t offset = 0;  ///< In bytes from the beginning.
  std::string what;
};

/// What of a recording gave no frame.
struct RecordingStrays {
  std::size_t unknown = 0;                ///< Lines, or records, that are no frame of any kind.
  std::size_t first = 0;                  ///< Number of the first of them, from 1.
  std::size_t unsuited = 0;               ///< CAN FD, or another bus system.
  bool records = false;                   ///< They are records, not lines.
  std::optional<RecordingDamage> damage;  ///< All frames in front of it were taken.

  void add_unknown(std::size_t number) {
    if (unknown++ == 0) first = number;
  }
};

/// Calls `take` with each frame, in the order of the file, until it answers false.
RecordingStrays for_each_frame(std::string_view content, const TakeLogFrame& take);

/// The buses that have frames in it, by their names as `decode` shows them, and how many; error frames are
/// none.
std::map<std::string, std::size_t> frames_of_buses(std::string_view content);

/// `can0 (12), can1 (7)`, for messages.
std::string list_of(const std::map<std::string, std::size_t>& buses);

}  // namespace servoctl::can
