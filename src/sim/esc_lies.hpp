#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/bytes.hpp"
#include "base/time.hpp"
#include "sim/esc_faults.hpp"

namespace servoctl::sim {

/// The words of `lie=` on EtherCAT.
inline constexpr std::array<std::string_view, 8> kRingLies{
    "wkc", "wkc-max", "silent-mailbox", "frozen-inputs", "frozen-outputs", "al-state", "statusword", "mode"};

/// Deviations of a slave that begin so long after its drive was enabled for the first time: before, it would
/// not be enabled.
struct EscLies {
  std::vector<std::string_view> words;  ///< Of kRingLies.
  Duration after{};
  std::optional<Duration> length;  ///< Empty: for ever.
};

/// Sets the fault that the word names; those of the drive itself (`statusword`, `mode`) are not among them.
void add_lie(EscFaults& faults, std::string_view word);

/// What faults of the process data make of a frame that has passed the slave; `before` is the frame as it
/// came.
void falsify_process_data(std::span<std::uint8_t> frame, ByteSpan before, const EscFaults& faults);

}  // namespace servoctl::sim
