#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "can/link_change.hpp"

/// An interface of the kernel brought up as somebody wants it, and down.
namespace servoctl::session {

/// How an interface is wanted; what is empty stays as it is.
struct BusWish {
  std::optional<std::uint32_t> bitrate = {};       ///< In bit/s.
  std::optional<std::uint16_t> sample_point = {};  ///< In thousandths of a bit.
  std::optional<std::uint32_t> restart_ms = {};
  std::optional<std::uint32_t> queue_length = {};
};

/// What has to be done for it.
struct BusPlan {
  std::vector<can::LinkChange> steps;  ///< Empty: it is as wanted.
  bool stops_bus = false;              ///< It takes part in its bus now, and is taken down.
  std::vector<std::string>
      differs;  ///< What is otherwise now, a phrase each: `500 kbit/s instead of 250 kbit/s`.
};

/// What brings the interface up as wanted, from the state it is in. Errc::usage for settings that its kind
/// does not have, and where nobody has said a bitrate yet.
Result<BusPlan> plan_bus_up(const std::string& name, const can::LinkState& now, const BusWish& wish);

/// Does it. When a step fails the interface is put back to what it was, and the error says whether that
/// succeeded. Errors as LinkControl::change().
Result<void> set_up(can::LinkControl& link, const can::LinkState& before, const BusPlan& plan);

/// What it holds now that is not as it was wanted: a bitrate or sample point that the controller rounds. A
/// phrase each.
std::vector<std::string> rounded(const can::LinkState& now, const BusWish& wish);

/// `500 kbit/s, sample point 87.5 %`; empty where it has no bitrate.
std::string settings_text(const can::LinkState& state);

}  // namespace servoctl::session
