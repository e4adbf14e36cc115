#include "session/open_port.hpp"

#include <fmt/format.h>
#include <utility>

#include "base/text.hpp"
#include "sim/sim_port.hpp"

namespace servoctl::session {
namespace {

constexpr std::string_view kScheme = "coe:";

}  // namespace

bool is_ethercat(std::string_view url) { return url.starts_with(kScheme); }

Result<std::unique_ptr<ethernet::Port>> open_port(std::string_view url, const BusOptions& options) {
  const auto rest = is_ethercat(url) ? url.substr(kScheme.size()) : std::string_view();
  const auto colon = rest.find(':');
  const auto scheme = rest.substr(0, colon);
  if (scheme == "sim" && colon != std::string_view::npos)
    return sim::open_sim_port(rest.substr(colon + 1), options.drive_folders, options.clock);
  const std::string schemes[] = {"sim"};
  auto hint = did_you_mean(scheme, schemes);
  if (hint.empty()) hint = "write coe:sim:sv2@1";
  return fail(Errc::usage, fmt::format("'{}' is not an EtherCAT bus", url), std::move(hint));
}

}  // namespace servoctl::session
