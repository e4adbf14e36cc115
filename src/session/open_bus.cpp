#include "session/open_bus.hpp"

#include <algorithm>
#include <array>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "can/local.hpp"
#include "can/replay.hpp"
#include "can/slcan.hpp"
#include "can/slcan_place.hpp"
#include "can/socketcan.hpp"
#include "can/socketcand.hpp"
#include "can/trace.hpp"
#include "gateway/address.hpp"
#include "session/open_port.hpp"
#include "sim/cell.hpp"

namespace servoctl::session {
namespace {

constexpr std::array<std::string_view, 9> kSchemes{"socketcan", "slcan",  "socketcand", "gateway", "local",
                                                   "sim",       "replay", "coe",        "modbus"};
constexpr std::string_view kForms =
    "write can0, slcan:/dev/ttyACM0@500k, socketcand://HOST/can0, gateway://HOST, coe:eth0, modbus:/dev/ttyUSB0@19200,8E1, local:NAME, "
    "sim:FAMILY@NODE or replay:FILE";

tl::unexpected<Error> no_bus(std::string_view url) {
  auto hint =
      did_you_mean(url.substr(0, url.find(':')), std::vector<std::string>(kSchemes.begin(), kSchemes.end()));
  if (hint.empty()) hint = kForms;
  return fail(Errc::usage, message("'{}' is not a bus", as_it_is(url)), std::move(hint));
}

Result<std::unique_ptr<can::Bus>> open_plain(std::string_view url, const BusOptions& options) {
  const auto colon = url.find(':');
  if (colon == std::string_view::npos && !url.empty()) return can::open_socketcan(url);
  const auto scheme = url.substr(0, colon);
  const auto rest = colon == std::string_view::npos ? std::string_view() : url.substr(colon + 1);
  if (scheme == "socketcan") return can::open_socketcan(rest);
  if (scheme == "slcan") return can::open_slcan(rest);
  if (scheme == "socketcand") return can::open_socketcand(rest);
  if (scheme == "local") return can::open_local(rest);
  if (scheme == "sim") return sim::open_sim(rest, options.drive_folders, options.clock);
  if (scheme == "replay") return can::open_replay(rest);
  return no_bus(url);
}

}  // namespace

Result<void> check_url(std::string_view url) {
  const auto colon = url.find(':');
  const bool known = colon == std::string_view::npos
                         ? !url.empty()
                         : std::count(kSchemes.begin(), kSchemes.end(), url.substr(0, colon)) > 0;
  if (!known) return no_bus(url);
  if (colon + 1 == url.size())
    return fail(Errc::usage, message("'{}' names no bus", as_it_is(url)), std::string(kForms));
  const auto scheme = url.substr(0, colon);
  const auto rest = url.substr(colon + 1);
  if (scheme == "slcan")
    if (const auto place = can::parse_slcan_place(rest); !place) return fail(place.error());
  if (scheme == "gateway")
    if (const auto place = gateway::parse_url(rest); !place) return fail(place.error());
  if (scheme == "socketcand")
    if (const auto place = can::parse_socketcand_place(rest); !place) return fail(place.error());
  return {};
}

Result<std::unique_ptr<can::Bus>> open_bus(std::string_view url, const BusOptions& options) {
  if (is_pcap(options.trace))
    return fail(Errc::usage,
                message("the trace of a CAN bus is no pcap: {} would hold lines of candump",
                        as_it_is(options.trace.string())),
                message("name it {}.log; .pcap is for the frames of a coe: bus",
                        as_it_is(options.trace.stem().string())));
  auto bus = open_plain(url, options);
  if (!bus || options.trace.empty()) return bus;
  const auto colon = url.find(':');
  const auto name = url.substr(0, colon) == "socketcan" ? url.substr(colon + 1) : url.substr(0, colon);
  // These clocks do not run with the wall's.
  const bool simulated =
      name == "replay" || (name == "sim" && options.clock == sim::SimBus::Clock::virtual_time);
  return can::trace_to(std::move(*bus), options.trace, name,
                       simulated ? can::TraceClock::bus : can::TraceClock::wall, options.trace_failed);
}

std::string canonical_url(std::string_view url) {
  constexpr std::string_view kPlain = "socketcan:";
  if (url.starts_with(kPlain)) url.remove_prefix(kPlain.size());
  return std::string(url);
}

namespace {

std::optional<can::SlcanPlace> slcan_place_of(std::string_view url) {
  constexpr std::string_view kSerial = "slcan:";
  if (!url.starts_with(kSerial)) return std::nullopt;
  auto place = can::parse_slcan_place(url.substr(kSerial.size()));
  return place ? std::optional(std::move(*place)) : std::nullopt;
}

}  // namespace

std::string url_without_bitrate(std::string_view url) {
  const auto place = slcan_place_of(url);
  return place ? "slcan:" + place->device : canonical_url(url);
}

std::optional<std::uint32_t> bitrate_of(std::string_view url) {
  if (const auto link = link_of(url)) return link->bitrate;
  const auto place = slcan_place_of(url);
  return place ? std::optional(place->bitrate) : std::nullopt;
}

bool runs_at(std::string_view url, std::uint32_t bitrate) {
  if (const auto known = bitrate_of(url)) return *known == bitrate;
  // A driver may keep its bitrate to itself: only what cannot have one takes any.
  if (const auto link = link_of(url)) return link->kind == "vcan" || link->kind == "vxcan";
  return url.starts_with("sim:") || url.starts_with("local:");
}

bool carries_remote_frames(std::string_view url) { return !url.starts_with("socketcand:"); }

std::optional<can::LinkState> link_of(std::string_view url) {
  const auto colon = url.find(':');
  if (colon == std::string_view::npos) return can::link_state(url);
  return url.substr(0, colon) == "socketcan" ? can::link_state(url.substr(colon + 1)) : std::nullopt;
}

}  // namespace servoctl::session
