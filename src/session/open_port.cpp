#include "session/open_port.hpp"

#include <fmt/format.h>
#include <utility>

#include "base/text.hpp"
#include "ethernet/local_port.hpp"
#include "ethernet/raw_port.hpp"
#include "sim/sim_port.hpp"

namespace servoctl::session {
namespace {

using ethernet::End;

constexpr std::string_view kScheme = "coe:";

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
  return fail(Errc::usage, fmt::format("'{}' is not an EtherCAT bus", url), std::move(hint));
}

Result<std::unique_ptr<ethernet::Port>> open_wire(std::string_view url, End end) {
  if (!is_ethercat(url)) return no_port(url, {});
  const auto [scheme, rest] = place_of(url);
  if (scheme.empty() && !rest.empty()) return ethernet::open_raw_port(rest, end);
  if (scheme == "local") return ethernet::open_local_port(rest, end);
  return no_port(url, scheme);
}

}  // namespace

bool is_ethercat(std::string_view url) { return url.starts_with(kScheme); }

Result<std::unique_ptr<ethernet::Port>> open_port(std::string_view url, const BusOptions& options) {
  if (is_ethercat(url) && place_of(url).scheme == "sim")
    return sim::open_sim_port(place_of(url).rest, options.drive_folders, options.clock);
  return open_wire(url, End::master);
}

Result<std::unique_ptr<ethernet::Port>> open_ring_port(std::string_view url) {
  if (is_ethercat(url) && place_of(url).scheme == "sim")
    return fail(Errc::usage, "a simulated drive cannot be put on a bus that is simulated itself",
                "use a bus others can reach: coe:local:NAME, or coe:veth1 on one end of a veth pair");
  return open_wire(url, End::ring);
}

}  // namespace servoctl::session
