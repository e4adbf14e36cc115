#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "can/bus.hpp"
#include "can/link.hpp"
#include "can/trace.hpp"
#include "drive/profile.hpp"
#include "sim/sim_bus.hpp"

namespace servoctl::session {

/// What is needed to open a bus beside its URL.
struct BusOptions {
  drive::Folders drive_folders;        ///< Where simulated drives find their data.
  std::filesystem::path trace;         ///< Every frame goes into this file; empty: none.
  can::TraceFailed trace_failed = {};  ///< See can::trace_to().
  sim::SimBus::Clock clock = sim::SimBus::Clock::real_time;
};

/// Opens a bus by URL: `can0` or `socketcan:can0`, `slcan:/dev/ttyACM0@500k`, `socketcand://HOST/can0`,
/// `local:NAME`, `sim:gsd600@1,gsd600@2?state=FILE`, `replay:FILE`. Errc::usage for a URL that is not
/// understood, Errc::bus with the mending command for an interface that is missing or down.
Result<std::unique_ptr<can::Bus>> open_bus(std::string_view url, const BusOptions& options);

/// Whether it may be the URL of a bus, before anything is opened: Errc::usage for a kind that there is not,
/// and for one without a name.
Result<void> check_url(std::string_view url);

/// The URL in the one form in which the same bus has the same: `socketcan:can0` is `can0`.
std::string canonical_url(std::string_view url);

/// Whether remote frames can be sent on it: the protocol of socketcand has none.
bool carries_remote_frames(std::string_view url);

/// The same bus at whatever bitrate: an adapter whose URL names one is `slcan:/dev/ttyACM0`.
std::string url_without_bitrate(std::string_view url);

/// The bitrate of a bus in bit/s, where its URL or the kernel tells it.
std::optional<std::uint32_t> bitrate_of(std::string_view url);

/// Whether a bus that is open runs at this bitrate, in bit/s: what its URL or the kernel tells is that. A bus
/// that is simulated or virtual has none, and any is right; of a gateway or a socketcand nothing is known.
bool runs_at(std::string_view url, std::uint32_t bitrate);

/// What the kernel knows of the CAN interface behind a URL; empty for any other bus.
std::optional<can::LinkState> link_of(std::string_view url);

}  // namespace servoctl::session
