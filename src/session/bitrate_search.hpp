#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "can/link_change.hpp"

/// The bitrate of a bus found by listening: nothing is sent, not even an acknowledge.
namespace servoctl::session {

/// What was heard at one bitrate.
struct Heard {
  std::uint32_t bitrate = 0;
  std::size_t frames = 0;
  std::size_t errors = 0;  ///< On the wire; some drivers tell none.
  enum class Verdict : std::uint8_t {
    silent,       ///< Nothing.
    fits,         ///< Frames.
    errors,       ///< Somebody talks, but not at this bitrate; or the wiring is bad.
    unreachable,  ///< The controller cannot have it.
  } verdict = Verdict::silent;
};

/// `silent`, `frames`, `errors only`, `not possible`
std::string_view name(Heard::Verdict verdict);

/// In bit/s: those of CiA 301, 5.2, and 100 kbit/s, which is in use as well; the likely ones first.
std::span<const std::uint32_t> usual_bitrates();

/// Told while it listens how much of that is done, on the clock of the interface.
using Listening = std::function<void(double share, TimePoint begin, TimePoint now)>;

struct SearchOptions {
  std::vector<std::uint32_t> bitrates;
  Duration each = std::chrono::seconds(2);      ///< How long it listens at one; a heartbeat has to fit in.
  std::function<bool()> cancelled = {};         ///< Asked in every wait; may be empty.
  std::function<void(const Heard&)> told = {};  ///< Each as it is known; may be empty.
  Listening listening = {};                     ///< Of each; may be empty.
};

struct Search {
  std::vector<Heard> heard;              ///< In the order in which they were tried.
  std::optional<std::uint32_t> bitrate;  ///< The first that fits; the search ends with it.
};

/// Listens at each bitrate in turn, listen-only, and puts the interface back to what it was on every way out.
/// It is taken down for it where it is up. Errc::usage where the driver has no listen-only mode or the kind
/// no bitrate, Errc::interrupted when cancelled, Errc::bus when the interface is lost; its own error where
/// the interface could not be put back.
Result<Search> search_bitrate(can::LinkControl& link, const SearchOptions& options);

/// Listens for so long to what passes, as the interface is now: frames of this machine as well. Ends as soon
/// as the verdict is clear.
Result<Heard> hear(can::Bus& bus, Duration time, const std::function<bool()>& cancelled,
                   const Listening& listening = {});

}  // namespace servoctl::session
