#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "ethernet/port.hpp"
#include "session/open_bus.hpp"

namespace servoctl::session {

/// Whether the URL is that of a wire with EtherCAT: `coe:…`.
bool is_ethercat(std::string_view url);

/// Whether the name is that of a trace of Ethernet frames: `.pcap` or `.pcapng`.
bool is_pcap(const std::filesystem::path& file);

/// What URLs of such wires begin with on this machine: `coe:eth0`, `coe:local:`, `coe:sim:`.
std::vector<std::string> ethercat_urls();
/// The Ethernet ports of this machine with somebody at the other end of their cable: `coe:eth0`.
std::vector<std::string> ethercat_links();

/// Opens a wire with an EtherCAT ring by URL, as its master: `coe:eth0`, `coe:local:NAME`,
/// `coe:sim:sv2@1,sv2@2?state=FILE`.
/// Errc::usage for a URL that is not understood, and for a trace whose name is not is_pcap(); else as
/// open_raw_port(), open_local_port(), open_sim_port().
Result<std::unique_ptr<ethernet::Port>> open_port(std::string_view url, const BusOptions& options);

/// The other end of such a wire, for who stands for its slaves: `coe:eth0`, `coe:local:NAME`.
Result<std::unique_ptr<ethernet::Port>> open_ring_port(std::string_view url, const BusOptions& options);

}  // namespace servoctl::session
