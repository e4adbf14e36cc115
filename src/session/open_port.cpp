#include "session/open_port.hpp"

#include <utility>

#include "base/format.hpp"
#include "base/offer.hpp"
#include "base/text.hpp"
#include "ethernet/interface.hpp"
#include "ethernet/local_port.hpp"
#include "ethernet/pcap_trace.hpp"
#include "ethernet/raw_port.hpp"
#include "sim/sim_port.hpp"

namespace servoctl::session {
namespace {

using ethernet::End;

constexpr std::string_view kScheme = "coe:";

/// What Wireshark opens, so that nobody takes it for a trace of CAN.
Result<void> check_trace_name(const std::filesystem::path& file) {
  if (is_pcap(file)) return {};
  return fail(Errc::usage,
              message("the trace of an EtherCAT bus is a .pcap or .pcapng, not {}", as_it_is(file.string())),
              message("name it {}.pcap; Wireshark opens it", as_it_is(file.stem().string())));
}

/// What stands behind `coe:`, taken apart: `local` and `cell`; an interface has no scheme.
struct Place {
  std::string_view scheme;
  std::string_view rest;
};

Place place_of(std::string_view url) {
  url.remove_prefix(kScheme.size());
  const auto colon = url.find(':');
  if (colon == std::string_view::npos) return {{}, url};
  return {url.substr(0, colon), url.substr(colon + 1)};
}

tl::unexpected<Error> no_port(std::string_view url, std::string_view scheme) {
  const std::string schemes[] = {"local", "sim"};
  auto hint = did_you_mean(scheme, schemes);
  if (hint.empty()) hint = "write coe:eth0, coe:local:NAME or coe:sim:FAMILY@1";
  return fail(Errc::usage, message("'{}' is not an EtherCAT bus", as_it_is(url)), std::move(hint));
}

Result<std::unique_ptr<ethernet::Port>> open_wire(std::string_view url, End end) {
  if (!is_ethercat(url)) return no_port(url, {});
  const auto [scheme, rest] = place_of(url);
  if (scheme.empty() && !rest.empty()) return ethernet::open_raw_port(rest, end);
  if (scheme == "local") return ethernet::open_local_port(rest, end);
  return no_port(url, scheme);
}

/// With a trace where one is wanted; what is wrong with its name is told before anything is opened.
template <class Open>
Result<std::unique_ptr<ethernet::Port>> traced(std::string_view url, const BusOptions& options,
                                               can::TraceClock clock, Open open) {
  if (!options.trace.empty())
    if (const auto named = check_trace_name(options.trace); !named) return fail(named.error());
  Result<std::unique_ptr<ethernet::Port>> port = open();
  if (!port || options.trace.empty()) return port;
  auto name = url.substr(kScheme.size());
  if (place_of(url).scheme == "sim") name = "sim";
  return ethernet::pcap_to(std::move(*port), options.trace, name, clock, options.trace_failed);
}

}  // namespace

bool is_pcap(const std::filesystem::path& file) {
  const auto ending = file.extension().string();
  return equals_nocase(ending, ".pcap") || equals_nocase(ending, ".pcapng");
}

std::vector<std::string> ethercat_urls() {
  std::vector<std::string> out;
  for (const auto& interface : ethernet::ethernet_interfaces())
    out.push_back(std::string(kScheme) + interface);
  for (const auto* scheme : {"local:", "sim:"}) out.push_back(std::string(kScheme) + scheme);
  return out;
}

std::vector<std::string> ethercat_links() {
  std::vector<std::string> out;
  for (const auto& interface : ethernet::ethernet_interfaces())
    if (ethernet::has_link(interface)) out.push_back(std::string(kScheme) + interface);
  return out;
}

bool is_ethercat(std::string_view url) { return url.starts_with(kScheme); }

Result<std::unique_ptr<ethernet::Port>> open_port(std::string_view url, const BusOptions& options) {
  const bool is_simulated = is_ethercat(url) && place_of(url).scheme == "sim";
  if (!is_simulated)
    return traced(url, options, can::TraceClock::wall, [&] { return open_wire(url, End::master); });
  const auto clock =
      options.clock == sim::SimClock::Kind::virtual_time ? can::TraceClock::bus : can::TraceClock::wall;
  return traced(url, options, clock,
                [&] { return sim::open_sim_port(place_of(url).rest, options.drive_folders, options.clock); });
}

Result<std::unique_ptr<ethernet::Port>> open_ring_port(std::string_view url, const BusOptions& options) {
  if (is_ethercat(url) && place_of(url).scheme == "sim")
    return fail(Errc::usage, "a simulated drive cannot be put on a bus that is simulated itself",
                "use a bus others can reach: coe:local:NAME, or coe:veth1 on one end of a veth pair");
  return traced(url, options, can::TraceClock::wall, [&] { return open_wire(url, End::ring); });
}

}  // namespace servoctl::session
